// What the next dispatch visits, and how many workgroups it has. One invocation runs before each
// dispatch of a stage. It closes what the dispatch before has ended: a round, or a stage.
//
// A dispatch that is encoded for another stage than the one under way gets no workgroups. So the
// host may encode more dispatches than a stage turns out to need, and fewer.

@group(2) @binding(0) var<storage, read_write> turn: Turn;
@group(2) @binding(2) var<storage, read> stage_parameters: Stage;
/// The workgroups of the dispatch, as an indirect dispatch reads them.
@group(2) @binding(3) var<storage, read_write> workgroups: array<u32, 3>;

/// The largest number of workgroups.
const MOST_GROUPS = 65535u * PARTS;

/// Workgroups that visit what is listed.
fn groups_of_round() -> u32 {
    switch turn.visits {
        case VISIT_ALL: {
            return turn.stage.tiles;
        }
        case VISIT_PARENTS: {
            return (turn.count + 15u) / 16u;
        }
        default: {
            return (turn.count + 63u) / 64u;
        }
    }
}

/// Goes on to the next round if this one is over, and to the next stage if no cell moves.
fn close_ended() {
    if turn.begun == 0u {
        return;
    }
    turn.first += turn.groups;
    turn.groups = 0u;
    if turn.first < groups_of_round() {
        return;
    }
    turn.count = atomicExchange(&cells.moving, 0u);
    if turn.count == 0u {
        turn.number += 1u;
        turn.begun = 0u;
        return;
    }
    turn.visits = VISIT_CELLS;
    turn.read = turn.filled;
    turn.filled = turn.stage.queues.x + turn.stage.queues.y - turn.read;
    turn.first = 0u;
    turn.done += turn.chunk;
    turn.chunk = min(4u * turn.chunk, turn.stage.most);
}

fn begin_stage() {
    turn.stage = stage_parameters;
    turn.begun = 1u;
    turn.chunk = turn.stage.chunk;
    turn.done = 0u;
    turn.first = 0u;
    turn.filled = turn.stage.queues.x;
    turn.dispatches = 0u;
    turn.visits = VISIT_ALL;
    if turn.stage.parent_width > 0u {
        turn.visits = VISIT_PARENTS;
        var count = atomicExchange(&cells.parents, 0u);
        // The rays of every sample have the same parents.
        if turn.stage.divisor == 1u {
            if turn.stage.before > 0u {
                count = cells.traced;
            }
            cells.traced = count;
        }
        // A stage without tiles is left out.
        turn.count = select(0u, count, turn.stage.tiles > 0u);
        turn.read = turn.stage.listed;
    }
}

@compute @workgroup_size(1)
fn arrange() {
    close_ended();
    if turn.number == stage_parameters.number {
        if turn.begun == 0u {
            begin_stage();
        }
        // A stage may have nothing to visit.
        let left = groups_of_round() - turn.first;
        let most = clamp(stage_parameters.slice / turn.chunk, 1u, MOST_GROUPS);
        turn.groups = (min(left, most) + PARTS - 1u) / PARTS * PARTS;
        turn.dispatches += min(turn.groups, 1u);
        cells.dispatches[stage_parameters.index] = turn.dispatches;
    }
    workgroups = array<u32, 3>(turn.groups / PARTS, PARTS, 1u);
}
