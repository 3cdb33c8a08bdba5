// The cells that a dispatch visits, and what is kept of each cell.
//
// Within a stage, the first round does a few steps, and each later one visits the cells that
// still move. They are packed densely, so that a few long rays do not keep other lanes waiting.
// The order of a list may vary, the result of a cell does not.

/// The turn is in storage, as lavapipe inlines uniforms that steer branches and compiles again
/// whenever one changes.
@group(2) @binding(0) var<storage, read> turn_parameters: Turn;
var<private> turn: Turn;

/// The state of a cell that was not visited: its parent is sky.
const STATE_UNVISITED = 0xffffffffu;

const QUEUE_NONE = 0xffffffffu;

fn queue_load() {
    turn = turn_parameters;
}

/// A place in the block as one word, or QUEUE_NONE beyond its edges. Lists hold such words, as a
/// division by the width would take a software device longer than all else here.
fn queue_pack(cell: vec2<u32>) -> u32 {
    return select(cell.x | (cell.y << 16u), QUEUE_NONE, any(cell >= turn.stage.cells));
}

/// The place of a packed cell in the block.
fn queue_cell(packed: u32) -> vec2<u32> {
    return vec2<u32>(packed & 0xffffu, packed >> 16u);
}

/// The index of a cell in the block.
fn queue_index(cell: vec2<u32>) -> u32 {
    return cell.y * turn.stage.cells.x + cell.x;
}

/// The remainder and the quotient. Exact for `a` up to 2^20, the most pixels of a block, as WGSL
/// divides floats to within 2.5 units in the last place.
fn queue_divide(a: u32, by: u32) -> vec2<u32> {
    let quotient = u32((f32(a) + 0.5) / f32(by));
    return vec2<u32>(a - quotient * by, quotient);
}

/// The place of a workgroup in its round. Software devices give each thread a run of consecutive
/// workgroups. So the parts of a dispatch are taken in bit-reversed order: each half of them, and
/// each quarter, has its share of every region of the image. Without this, one thread waited for
/// another. Within a part the order stays, as neighbours in a list should be neighbours in the
/// image.
fn queue_group(group: vec2<u32>) -> u32 {
    let part = reverseBits(group.y) >> 28u;
    return turn.first + part * (turn.groups / PARTS) + group.x;
}

/// This invocation's cell in a stage that visits all cells, packed, or QUEUE_NONE.
fn queue_tile(group: vec2<u32>, lane: u32) -> u32 {
    let tile = queue_divide(queue_group(group), (turn.stage.cells.x + 7u) / 8u);
    return queue_pack(tile_cell(tile, lane));
}

/// This invocation's cell, packed, or QUEUE_NONE.
fn queue_take(group: vec2<u32>, lane: u32) -> u32 {
    if turn.visits == VISIT_ALL {
        return queue_tile(group, lane);
    }
    let at = queue_group(group) * 64u + lane;
    if turn.visits == VISIT_CELLS {
        if at >= turn.count {
            return QUEUE_NONE;
        }
        return cells.words[turn.read + at];
    }
    if at >= 4u * turn.count {
        return QUEUE_NONE;
    }
    let parent = queue_cell(cells.words[turn.read + at / 4u]);
    return queue_pack(2u * parent + vec2<u32>(at & 1u, (at >> 1u) & 1u));
}

/// The front of a cell's parent.
fn queue_front(cell: vec2<u32>) -> f32 {
    if turn.stage.parent_width == 0u {
        return 0.0;
    }
    let parent = (cell.y / 2u) * turn.stage.parent_width + cell.x / 2u;
    return bitcast<f32>(cells.words[turn.stage.parent_front + parent]);
}

/// The step limit of a cell in this dispatch.
fn queue_steps() -> u32 {
    return min(turn.chunk, turn.stage.limit - turn.done);
}

/// Whether a packed cell that still moves has reached its limit. If not, it is queued.
fn queue_push(cell: u32) -> bool {
    if turn.done + turn.chunk >= turn.stage.limit {
        return true;
    }
    let at = atomicAdd(&cells.moving, 1u);
    cells.words[turn.filled + at] = cell;
    return false;
}

/// Lists a packed cell whose children the next stage visits.
fn queue_parent(cell: u32) {
    let at = atomicAdd(&cells.parents, 1u);
    cells.words[turn.stage.parents + at] = cell;
}

fn cell_front(cell: u32) -> f32 {
    return bitcast<f32>(cells.words[turn.stage.front + cell]);
}

/// The state whose place among all values is `at`.
fn cell_state(at: u32) -> u32 {
    let kept = cells.words[at];
    return select(STATE_UNVISITED, kept & 3u, kept >> 2u == turn.stage.generation);
}

fn cell_store(cell: u32, front: f32, state: u32) {
    cells.words[turn.stage.front + cell] = bitcast<u32>(front);
    cells.words[turn.stage.state + cell] = (turn.stage.generation << 2u) | state;
}

fn cell_mark(cell: u32) -> Mark {
    let at = turn.stage.mark + 3u * cell;
    return Mark(cells.words[at], bitcast<f32>(cells.words[at + 1u]), bitcast<f32>(cells.words[at + 2u]));
}

fn cell_store_mark(cell: u32, mark: Mark) {
    let at = turn.stage.mark + 3u * cell;
    cells.words[at] = mark.id;
    cells.words[at + 1u] = bitcast<u32>(mark.u);
    cells.words[at + 2u] = bitcast<u32>(mark.v);
}

fn cell_pixel(pixel: u32) -> vec4<f32> {
    let at = turn.stage.light + 4u * pixel;
    let w = vec4<u32>(cells.words[at], cells.words[at + 1u], cells.words[at + 2u], cells.words[at + 3u]);
    return bitcast<vec4<f32>>(w);
}

fn cell_store_pixel(pixel: u32, value: vec4<f32>) {
    let at = turn.stage.light + 4u * pixel;
    let w = bitcast<vec4<u32>>(value);
    cells.words[at] = w.x;
    cells.words[at + 1u] = w.y;
    cells.words[at + 2u] = w.z;
    cells.words[at + 3u] = w.w;
}
