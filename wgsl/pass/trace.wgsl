// The last level: one ray per pixel, from the front of its cell to the surface.
// The loop counts and caps; what a step is, the scene knows. A ray that needs more steps
// than one dispatch may do is put down in `walks` and taken up by the next, so that no
// dispatch is long; the walk is the same whatever the cuts.

@group(2) @binding(5) var<storage, read_write> depth: array<f32>;
@group(2) @binding(6) var<storage, read_write> state: array<u32>;
/// Rays that still move, between two dispatches; of all others the content is old.
@group(2) @binding(7) var<storage, read_write> walks: array<Walk>;
/// What was hit, of scenes whose hits name something; else a stub.
@group(2) @binding(8) var<storage, read_write> marks: array<Mark>;

@compute @workgroup_size(64)
fn trace(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    scene_load();
    view_load();
    queue_load();
    let index = queue_take(group.xy, lane, view.block_size);
    if index == QUEUE_NONE {
        return;
    }
    // Buffers are of a block, rays of the whole image: only so is a picture made in blocks
    // the same as one made at once.
    let local = vec2<u32>(index % view.block_size.x, index / view.block_size.x);
    let ray = view_ray(view.block_origin + local);
    var walk: Walk;
    if turn.done > 0u {
        walk = walks[index];
    } else {
        walk = begin(ray, queue_front(local), bounds_far());
    }
    var s = STATE_MOVING;
    let last = queue_steps();
    for (var i = 0u; i < last; i++) {
        s = walk_step(ray, &walk);
        if s != STATE_MOVING {
            break;
        }
    }
    if s == STATE_MOVING {
        if queue_push(index) {
            s = STATE_UNCONVERGED;
        } else {
            walks[index] = walk;
        }
    }
    // Written in every dispatch, be the ray done or not: at the limit t is how far it got,
    // which is what an unconverged pixel shows.
    let hit = walk_hit(walk);
    depth[index] = hit.t;
    state[index] = s;
    if HIT_CARRIES_MARK {
        marks[index] = Mark(hit.id, hit.uv.x, hit.uv.y);
    }
    counters_store(index);
}
