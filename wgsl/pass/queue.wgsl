// Which cells a dispatch visits. The first pass visits every cell; a later one only the
// children of cells that are not sky, which the pass before it listed. Within a pass,
// the first dispatch does a few steps; each later one visits only the cells that still
// move, packed densely, so that a few long walks do not hold up the lanes of their
// neighbours.
//
// The order of a list depends on the machine; what is computed for a cell does not.
//
// The numbers of a dispatch lead the list that it reads, in storage: lavapipe inlines
// uniforms that steer branches, compiling anew whenever one changes.

struct Turn {
    /// Steps that this dispatch may do, that all before it did, and that all may.
    chunk: u32,
    done: u32,
    limit: u32,
    /// Workgroups per row of the dispatch.
    row: u32,
    /// Cells per row of the parent level in the block; 0 where there is none.
    parent_width: u32,
    /// 1 to visit the listed cells, 0 to visit all.
    listed: u32,
    count: u32,
    cells: array<u32>,
}

/// The same, to be filled: only count and cells are.
struct Queue {
    chunk: u32,
    done: u32,
    limit: u32,
    row: u32,
    parent_width: u32,
    listed: u32,
    count: atomic<u32>,
    cells: array<u32>,
}

const QUEUE_NONE = 0xffffffffu;

@group(2) @binding(1) var<storage, read> turn: Turn;
@group(2) @binding(2) var<storage, read_write> queue: Queue;

/// The cell of this invocation in a block of so many, or QUEUE_NONE.
fn queue_take(group: vec2<u32>, lane: u32, cells: vec2<u32>) -> u32 {
    if turn.listed > 0u {
        let at = (group.y * turn.row + group.x) * 64u + lane;
        if at >= turn.count {
            return QUEUE_NONE;
        }
        return turn.cells[at];
    }
    let cell = tile_cell(group, lane);
    if any(cell >= cells) {
        return QUEUE_NONE;
    }
    return cell.y * cells.x + cell.x;
}

/// Steps that a cell may do in this dispatch.
fn queue_steps() -> u32 {
    return min(turn.chunk, turn.limit - turn.done);
}

/// Whether a cell that still moves has come to its limit; if not, it is queued.
fn queue_push(cell: u32) -> bool {
    if turn.done + turn.chunk >= turn.limit {
        return true;
    }
    let at = atomicAdd(&queue.count, 1u);
    queue.cells[at] = cell;
    return false;
}
