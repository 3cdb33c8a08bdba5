// The work of a cell, kept beside its result where work is counted.

/// Stores the work of this dispatch and of those before, for all samples.
fn tally_store(cell: u32) {
    if !COUNTS_WORK {
        return;
    }
    let at = turn.stage.tally + 2u * cell;
    var work = counted();
    if turn.done > 0u || turn.stage.before > 0u {
        // Not beyond the largest number.
        let before = vec2<u32>(cells.words[at], cells.words[at + 1u]);
        work += min(before, vec2<u32>(0xffffffffu) - work);
    }
    cells.words[at] = work.x;
    cells.words[at + 1u] = work.y;
}
