// One level of the pyramid: every cell advances its cone from the front of its parent, as far
// as the scene proves it free. Children of sky cells are not visited.

struct LevelUniform {
    /// Pixels per cell, along each axis.
    divisor: u32,
    /// Factor on the cone's chord.
    fudge: f32,
    /// First cell of the block, and cells in the block.
    origin: vec2<u32>,
    cells: vec2<u32>,
}

@group(2) @binding(0) var<storage, read> level_parameters: LevelUniform;
@group(2) @binding(5) var<storage, read_write> front: array<f32>;
@group(2) @binding(6) var<storage, read_write> state: array<u32>;
/// The cells that are not sky. The next pass starts with their children.
@group(2) @binding(7) var<storage, read_write> next_parents: Queue;

@compute @workgroup_size(64)
fn march(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    scene_load();
    view_load();
    queue_load();
    let level = level_parameters;
    let index = queue_take(group.xy, lane, level.cells);
    if index == QUEUE_NONE {
        return;
    }
    let local = vec2<u32>(index % level.cells.x, index / level.cells.x);
    var f = 0.0;
    if turn.done > 0u {
        f = front[index];
    } else {
        f = queue_front(local);
    }
    var cone = view_cone(level.origin + local, level.divisor);
    cone.k *= level.fudge;
    // The children go on from the front, whether the cell stopped or reached its step limit.
    var s = STATE_MOVING;
    let last = queue_steps();
    for (var i = 0u; i < last; i++) {
        let next = advance(cone, f);
        f = next.front;
        if f > bounds_far() {
            s = STATE_SKY;
            break;
        }
        if !next.going {
            s = STATE_HIT;
            break;
        }
    }
    front[index] = f;
    if s == STATE_MOVING && queue_push(index) {
        s = STATE_UNCONVERGED;
    }
    state[index] = s;
    if s == STATE_HIT || s == STATE_UNCONVERGED {
        let at = atomicAdd(&next_parents.count, 1u);
        next_parents.cells[at] = index;
    }
    counters_store(index);
}
