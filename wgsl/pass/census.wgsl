// The last stage of a block: it counts the cells that were left out. The children of a cell that is
// not sky must be visited, and the cells of the coarsest level. The states of the levels lie one
// after the other, the finest first.

/// Squares of four pixels per workgroup.
const CENSUS_SQUARES = 1024u;

/// How many cells of a square were left out, at a level of so many cells whose states start at
/// `at`.
fn left_out(square: vec2<u32>, size: vec2<u32>, at: u32) -> u32 {
    var count = 0u;
    for (var i = 0u; i < 4u; i++) {
        let cell = 2u * square + vec2<u32>(i & 1u, i >> 1u);
        if all(cell < size) {
            let state = cell_state(at + cell.y * size.x + cell.x);
            count += select(0u, 1u, state == STATE_UNVISITED || state == STATE_MOVING);
        }
    }
    return count;
}

@compute @workgroup_size(64)
fn census(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    queue_load();
    let squares = (turn.stage.cells + 1u) / 2u;
    let start = queue_group(group.xy) * CENSUS_SQUARES;
    let end = min(start + CENSUS_SQUARES, squares.x * squares.y);
    for (var i = start + lane; i < end; i += 64u) {
        var square = queue_divide(i, squares.x);
        var size = turn.stage.cells;
        var at = turn.stage.state;
        // A square is a cell of the next coarser level. The first of four also looks there.
        for (var divisor = 1u; divisor <= turn.stage.divisor; divisor *= 2u) {
            let above = at + size.x * size.y;
            let size_above = (size + 1u) / 2u;
            var wanted = true;
            if divisor < turn.stage.divisor {
                let state = cell_state(above + square.y * size_above.x + square.x);
                wanted = state == STATE_HIT || state == STATE_UNCONVERGED;
            }
            if wanted {
                let wrong = left_out(square, size, at);
                if wrong > 0u {
                    atomicAdd(&cells.wrong, wrong);
                }
            }
            if any((square & vec2<u32>(1u)) != vec2<u32>(0u)) {
                break;
            }
            square /= 2u;
            size = size_above;
            at = above;
        }
    }
}
