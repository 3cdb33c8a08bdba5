// The cells that a dispatch visits, and what is kept of each cell.
//
// Within a stage, the first round does a few steps, and each later one visits the cells that
// still move. They are packed densely, so that a few long rays do not keep other lanes waiting.
// The order of a list may vary, the result of a cell does not.

/// The turn is in storage, as lavapipe inlines uniforms that steer branches and compiles again
/// whenever one changes.
@group(2) @binding(0) var<storage, read> turn_parameters: Turn;
/// The values of all cells of the block, one plane after the other. Fronts are floats.
@group(2) @binding(2) var<storage, read_write> cells: array<u32>;
var<private> turn: Turn;

/// The state of a cell that was not visited: its parent is sky.
const STATE_UNVISITED = 0xffffffffu;

const QUEUE_NONE = 0xffffffffu;

fn queue_load() {
    turn = turn_parameters;
}

/// The index of a cell in the block, or QUEUE_NONE beyond its edges.
fn queue_index(cell: vec2<u32>) -> u32 {
    let size = turn.stage.cells;
    return select(cell.y * size.x + cell.x, QUEUE_NONE, any(cell >= size));
}

/// The index of this invocation's cell in a stage that visits all cells, or QUEUE_NONE.
fn queue_tile(group: u32, lane: u32) -> u32 {
    let tile = turn.first + group;
    let row = (turn.stage.cells.x + 7u) / 8u;
    return queue_index(tile_cell(vec2<u32>(tile % row, tile / row), lane));
}

/// The index of this invocation's cell, or QUEUE_NONE.
fn queue_take(group: u32, lane: u32) -> u32 {
    if turn.visits == VISIT_ALL {
        return queue_tile(group, lane);
    }
    let at = (turn.first + group) * 64u + lane;
    if turn.visits == VISIT_CELLS {
        if at >= turn.count {
            return QUEUE_NONE;
        }
        return lists.cells[turn.read + at];
    }
    if at >= 4u * turn.count {
        return QUEUE_NONE;
    }
    let parent = lists.cells[turn.read + at / 4u];
    let width = turn.stage.parent_width;
    let child = vec2<u32>(at & 1u, (at >> 1u) & 1u);
    return queue_index(2u * vec2<u32>(parent % width, parent / width) + child);
}

/// The place of a cell in the block.
fn queue_cell(index: u32) -> vec2<u32> {
    let width = turn.stage.cells.x;
    return vec2<u32>(index % width, index / width);
}

/// The front of a cell's parent.
fn queue_front(cell: vec2<u32>) -> f32 {
    if turn.stage.parent_width == 0u {
        return 0.0;
    }
    let parent = (cell.y / 2u) * turn.stage.parent_width + cell.x / 2u;
    return bitcast<f32>(cells[turn.stage.parent_front + parent]);
}

/// The step limit of a cell in this dispatch.
fn queue_steps() -> u32 {
    return min(turn.chunk, turn.stage.limit - turn.done);
}

/// Whether a cell that still moves has reached its limit. If not, it is queued.
fn queue_push(cell: u32) -> bool {
    if turn.done + turn.chunk >= turn.stage.limit {
        return true;
    }
    let at = atomicAdd(&lists.moving, 1u);
    lists.cells[turn.filled + at] = cell;
    return false;
}

/// Lists a cell whose children the next stage visits.
fn queue_parent(cell: u32) {
    let at = atomicAdd(&lists.parents, 1u);
    lists.cells[turn.stage.parents + at] = cell;
}

fn cell_front(cell: u32) -> f32 {
    return bitcast<f32>(cells[turn.stage.front + cell]);
}

fn cell_store(cell: u32, front: f32, state: u32) {
    cells[turn.stage.front + cell] = bitcast<u32>(front);
    cells[turn.stage.state + cell] = state;
}

fn cell_mark(cell: u32) -> Mark {
    let at = turn.stage.mark + 3u * cell;
    return Mark(cells[at], bitcast<f32>(cells[at + 1u]), bitcast<f32>(cells[at + 2u]));
}

fn cell_store_mark(cell: u32, mark: Mark) {
    let at = turn.stage.mark + 3u * cell;
    cells[at] = mark.id;
    cells[at + 1u] = bitcast<u32>(mark.u);
    cells[at + 2u] = bitcast<u32>(mark.v);
}
