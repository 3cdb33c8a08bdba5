// The first stage of a block: no cell is visited, and no work is counted. The states of all
// cells lie together from `state` on, the counts from `tally` to `mark`.

/// Words per workgroup.
const RESET_WORDS = 1024u;

@compute @workgroup_size(64)
fn reset(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    queue_load();
    let start = turn.stage.state + (turn.first + group.x) * RESET_WORDS;
    for (var i = lane; i < RESET_WORDS; i += 64u) {
        let at = start + i;
        if at < turn.stage.tally {
            cells[at] = STATE_UNVISITED;
        } else if at < turn.stage.mark {
            cells[at] = 0u;
        }
    }
}
