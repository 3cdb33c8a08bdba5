// One level of the pyramid: every cell advances its cone as far as the scene can
// prove it free, starting where its parent's proof ended. A child of a sky cell
// is never visited.

struct LevelUniform {
    /// Pixels per cell, along each axis.
    divisor: u32,
    /// Factor on the cone's chord.
    fudge: f32,
    /// First cell of the block, and cells in the block.
    origin: vec2<u32>,
    cells: vec2<u32>,
    /// Cells of the next level in the block.
    children: vec2<u32>,
}

@group(2) @binding(0) var<storage, read> level: LevelUniform;
@group(2) @binding(4) var<storage, read> parent_front: array<f32>;
@group(2) @binding(5) var<storage, read_write> front: array<f32>;
@group(2) @binding(6) var<storage, read_write> state: array<u32>;
/// The list that the next pass starts with.
@group(2) @binding(7) var<storage, read_write> next_cells: Queue;

/// Lists the children of a cell, four or what the image's edge leaves of them.
fn march_children(cell: vec2<u32>) {
    let low = 2u * cell;
    let high = min(low + vec2<u32>(2u), level.children);
    var at = atomicAdd(&next_cells.count, (high.x - low.x) * (high.y - low.y));
    for (var y = low.y; y < high.y; y++) {
        for (var x = low.x; x < high.x; x++) {
            next_cells.cells[at] = y * level.children.x + x;
            at += 1u;
        }
    }
}

@compute @workgroup_size(64)
fn march(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let index = queue_take(group.xy, lane, level.cells);
    if index == QUEUE_NONE {
        return;
    }
    let local = vec2<u32>(index % level.cells.x, index / level.cells.x);
    var f = 0.0;
    if turn.done > 0u {
        f = front[index];
    } else if turn.parent_width > 0u {
        f = parent_front[(local.y / 2u) * turn.parent_width + local.x / 2u];
    }
    var cone = view_cone(level.origin + local, level.divisor);
    cone.k *= level.fudge;
    // A cell that stops holds something, or may: its children look closer. One that
    // runs out of steps hands on what it has proven so far, which is as good.
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
        march_children(local);
    }
    counters_store(index);
}
