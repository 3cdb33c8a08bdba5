// One level of the pyramid: every cell advances its cone as far as the scene can
// prove it free, starting where its parent's proof ended. A child of a sky cell
// does nothing.

struct LevelUniform {
    /// Pixels per cell, along each axis.
    divisor: u32,
    /// Steps that one dispatch may do, and all dispatches of the level together.
    chunk: u32,
    limit: u32,
    /// Steps done by earlier dispatches of this level.
    done: u32,
    /// First cell of the block, and cells in the block.
    origin: vec2<u32>,
    cells: vec2<u32>,
    /// Cells per row of the parent level in the block; 0 for the first level.
    parent_width: u32,
    /// Factor on the cone's chord.
    fudge: f32,
    pad0: u32,
    pad1: u32,
}

@group(2) @binding(0) var<uniform> level: LevelUniform;
@group(2) @binding(1) var<storage, read> parent_front: array<f32>;
@group(2) @binding(2) var<storage, read> parent_state: array<u32>;
@group(2) @binding(3) var<storage, read_write> front: array<f32>;
@group(2) @binding(4) var<storage, read_write> state: array<u32>;
@group(2) @binding(5) var<storage, read_write> moving: array<atomic<u32>>;

@compute @workgroup_size(64)
fn march(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let local = tile_cell(group.xy, lane);
    if any(local >= level.cells) {
        return;
    }
    let index = local.y * level.cells.x + local.x;
    var f = 0.0;
    if level.done > 0u {
        if state[index] != STATE_MOVING {
            return;
        }
        f = front[index];
    } else if level.parent_width > 0u {
        let parent = (local.y / 2u) * level.parent_width + local.x / 2u;
        f = parent_front[parent];
        if parent_state[parent] == STATE_SKY {
            front[index] = f;
            state[index] = STATE_SKY;
            return;
        }
    }
    var cone = view_cone(level.origin + local, level.divisor);
    cone.k *= level.fudge;
    // A cell that stops holds something, or may: its children look closer. One that
    // ran out of steps hands on what it has proven so far, which is as good.
    var s = STATE_MOVING;
    let last = min(level.chunk, level.limit - level.done);
    for (var i = 0u; i < last; i++) {
        let next = advance(cone, f);
        if next > bounds_far() {
            f = next;
            s = STATE_SKY;
            break;
        }
        if next <= f {
            s = STATE_HIT;
            break;
        }
        f = next;
    }
    if s == STATE_MOVING && level.done + last >= level.limit {
        s = STATE_UNCONVERGED;
    }
    front[index] = f;
    state[index] = s;
    if s == STATE_MOVING {
        atomicAdd(&moving[0], 1u);
    }
    counters_store(index);
}
