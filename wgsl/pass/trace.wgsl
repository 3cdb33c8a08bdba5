// The trace pass: one ray per pixel, from the front of its cell to the surface.
//
// A ray that needs more steps than a dispatch may do is stored in `walks`, and the next
// dispatch goes on with it. This does not change the ray.

/// The rays that still move between two dispatches. All others are out of date.
@group(2) @binding(3) var<storage, read_write> walks: array<Walk>;

@compute @workgroup_size(64)
fn trace(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    scene_load();
    view_load();
    queue_load();
    let packed = queue_take(group.xy, lane);
    if packed == QUEUE_NONE {
        return;
    }
    // Buffers belong to a block, rays to the whole image: so blocks do not change a picture.
    let local = queue_cell(packed);
    let index = queue_index(local);
    // The centre has a ray anyway: its depth stays.
    if turn.stage.lens.x >= 0.0 && until_ended(index) > 0.0 {
        return;
    }
    let ray = view_ray_from(turn.stage.origin + local, turn.stage.place, turn.stage.lens);
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
        if queue_push(packed) {
            s = STATE_UNCONVERGED;
        } else {
            walks[index] = walk;
        }
    }
    // Written in every dispatch: an unconverged pixel shows how far its ray came.
    let hit = walk_hit(ray, walk);
    cell_store(index, hit.t, s);
    if HIT_CARRIES_MARK {
        cell_store_mark(index, Mark(hit.id, hit.uv.x, hit.uv.y));
    }
    tally_store(index);
}
