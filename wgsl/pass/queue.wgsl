// Which cells a dispatch visits. The first pass visits every cell; a later one only the
// children of cells that are not sky, which the pass before it listed as parents. Within
// a pass, the first dispatch does a few steps; each later one visits only the cells that
// still move, packed densely, so that a few long walks do not hold up the lanes of their
// neighbours.
//
// The order of a list depends on the machine; what is computed for a cell does not.

/// The numbers of a dispatch. They lead the list that it reads, in storage: lavapipe
/// inlines uniforms that steer branches, compiling anew whenever one changes.
struct Turn {
    /// Steps that this dispatch may do, that all before it did, and that all may.
    chunk: u32,
    done: u32,
    limit: u32,
    /// Workgroups per row of the dispatch.
    row: u32,
    /// Cells per row of the parent level in the block; 0 where there is none.
    parent_width: u32,
    /// What is visited: QUEUE_ALL, QUEUE_PARENTS or QUEUE_CELLS.
    visits: u32,
    /// Cells or parents in the list.
    count: u32,
}

struct Listed {
    turn: Turn,
    cells: array<u32>,
}

/// The same, to be filled: only the count and the cells are.
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

/// Every cell of the block, the list being empty.
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

/// The cell of this invocation in a block of so many, or QUEUE_NONE.
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

/// Where the proof of a cell's parent ended.
fn queue_front(cell: vec2<u32>) -> f32 {
    if turn.parent_width == 0u {
        return 0.0;
    }
    return parent_front[(cell.y / 2u) * turn.parent_width + cell.x / 2u];
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
