// The last stage of a block: it counts the cells that were not visited although their parent is
// not sky, or visited although it is. There must be none. The states of the levels lie one after
// the other, the finest first.

@compute @workgroup_size(64)
fn census(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    queue_load();
    let index = queue_tile(group.x, lane);
    if index == QUEUE_NONE {
        return;
    }
    let pixel = queue_cell(index);
    var cell = pixel;
    var size = turn.stage.cells;
    var at = turn.stage.state;
    // The first pixel of a cell answers for the cell.
    for (var divisor = 1u; all(pixel % divisor == vec2<u32>(0u)); divisor *= 2u) {
        let state = cells[at + cell.y * size.x + cell.x];
        let visited = state == STATE_SKY || state == STATE_HIT || state == STATE_UNCONVERGED;
        at += size.x * size.y;
        size = (size + 1u) / 2u;
        cell /= 2u;
        var wanted = true;
        if divisor < turn.stage.divisor {
            let parent = cells[at + cell.y * size.x + cell.x];
            wanted = parent == STATE_HIT || parent == STATE_UNCONVERGED;
        }
        if visited != wanted {
            atomicAdd(&lists.wrong, 1u);
        }
        if divisor >= turn.stage.divisor {
            break;
        }
    }
}
