// The last level: one ray per pixel, from the front of its cell to the surface.
// The loop counts and caps; what a step is, the scene knows.

struct TraceUniform {
    chunk: u32,
    limit: u32,
    done: u32,
    /// Cells per row of the last cone level in the block; 0 where there is none.
    parent_width: u32,
}

@group(2) @binding(0) var<uniform> level: TraceUniform;
@group(2) @binding(1) var<storage, read> parent_front: array<f32>;
@group(2) @binding(2) var<storage, read> parent_state: array<u32>;
@group(2) @binding(3) var<storage, read_write> depth: array<f32>;
@group(2) @binding(4) var<storage, read_write> state: array<u32>;
@group(2) @binding(5) var<storage, read_write> moving: array<atomic<u32>>;
@group(2) @binding(6) var<storage, read_write> walks: array<Walk>;
@group(2) @binding(7) var<storage, read_write> marks: array<Mark>;

@compute @workgroup_size(64)
fn trace(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let local = tile_cell(group.xy, lane);
    if any(local >= view.block_size) {
        return;
    }
    let index = local.y * view.block_size.x + local.x;
    let ray = view_ray(view.block_origin + local);
    var walk: Walk;
    if level.done > 0u {
        if state[index] != STATE_MOVING {
            return;
        }
        walk = walks[index];
    } else {
        var f = 0.0;
        if level.parent_width > 0u {
            let parent = (local.y / 2u) * level.parent_width + local.x / 2u;
            f = parent_front[parent];
            if parent_state[parent] == STATE_SKY {
                depth[index] = f;
                state[index] = STATE_SKY;
                return;
            }
        }
        walk = begin(ray, f, bounds_far());
    }
    var s = STATE_MOVING;
    let last = min(level.chunk, level.limit - level.done);
    for (var i = 0u; i < last; i++) {
        s = walk_step(ray, &walk);
        if s != STATE_MOVING {
            break;
        }
    }
    if s == STATE_MOVING {
        if level.done + last >= level.limit {
            s = STATE_UNCONVERGED;
        } else {
            walks[index] = walk;
            atomicAdd(&moving[0], 1u);
        }
    }
    let hit = walk_hit(walk);
    depth[index] = hit.t;
    state[index] = s;
    if HIT_CARRIES_MARK {
        marks[index] = Mark(hit.id, hit.uv.x, hit.uv.y);
    }
    counters_store(index);
}
