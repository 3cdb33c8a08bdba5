// The cells that a dispatch visits. The first pass visits every cell. A later pass visits the
// children of the cells that are not sky, which the pass before it listed. Within a pass, the
// first dispatch does a few steps, and each later one visits the cells that still move. They
// are packed densely, so that a few long rays do not keep other lanes waiting.
//
// The order of a list may vary, the result of a cell does not.

/// The numbers of a dispatch, at the head of the list that it reads. They are in storage, as
/// lavapipe inlines uniforms that steer branches and compiles again whenever one changes.
struct Turn {
    /// The step limit of this dispatch, the steps done before it, and the limit of the pass.
    chunk: u32,
    done: u32,
    limit: u32,
    /// Workgroups per row of the dispatch.
    row: u32,
    /// Cells per row of the parent level in the block; 0 if there is no parent level.
    parent_width: u32,
    /// The cells to visit: QUEUE_ALL, QUEUE_PARENTS or QUEUE_CELLS.
    visits: u32,
    /// Number of cells or parents in the list.
    count: u32,
}

struct Listed {
    turn: Turn,
    cells: array<u32>,
}

/// The same layout for the list that is filled. Only the count and the cells are written.
struct Queue {
    chunk: u32,
    done: u32,
    limit: u32,
    row: u32,
    parent_width: u32,
    visits: u32,
    count: atomic<u32>,
    cells: array<u32>,
}

/// Every cell of the block.
const QUEUE_ALL = 0u;
/// The children of the listed cells of the parent level.
const QUEUE_PARENTS = 1u;
/// The listed cells.
const QUEUE_CELLS = 2u;

const QUEUE_NONE = 0xffffffffu;

@group(2) @binding(1) var<storage, read> listed: Listed;
@group(2) @binding(2) var<storage, read_write> queue: Queue;
@group(2) @binding(4) var<storage, read> parent_front: array<f32>;
var<private> turn: Turn;

fn queue_load() {
    turn = listed.turn;
}

/// The index of this invocation's cell in a block of so many cells, or QUEUE_NONE.
fn queue_take(group: vec2<u32>, lane: u32, cells: vec2<u32>) -> u32 {
    var cell = tile_cell(group, lane);
    if turn.visits != QUEUE_ALL {
        let at = (group.y * turn.row + group.x) * 64u + lane;
        if turn.visits == QUEUE_CELLS {
            if at >= turn.count {
                return QUEUE_NONE;
            }
            return listed.cells[at];
        }
        if at >= 4u * turn.count {
            return QUEUE_NONE;
        }
        let parent = listed.cells[at / 4u];
        cell = 2u * vec2<u32>(parent % turn.parent_width, parent / turn.parent_width)
            + vec2<u32>(at & 1u, (at >> 1u) & 1u);
    }
    if any(cell >= cells) {
        return QUEUE_NONE;
    }
    return cell.y * cells.x + cell.x;
}

/// The front of a cell's parent.
fn queue_front(cell: vec2<u32>) -> f32 {
    if turn.parent_width == 0u {
        return 0.0;
    }
    return parent_front[(cell.y / 2u) * turn.parent_width + cell.x / 2u];
}

/// The step limit of a cell in this dispatch.
fn queue_steps() -> u32 {
    return min(turn.chunk, turn.limit - turn.done);
}

/// Whether a cell that still moves has reached its limit. If not, it is queued.
fn queue_push(cell: u32) -> bool {
    if turn.done + turn.chunk >= turn.limit {
        return true;
    }
    let at = atomicAdd(&queue.count, 1u);
    queue.cells[at] = cell;
    return false;
}
