// Work counters: evaluations of the estimate and iterations of the formula in this invocation.
// The stand-in `pass/counters_off.wgsl` is joined where work is not counted.

var<private> evaluations: u32 = 0u;
var<private> iterations: u32 = 0u;

fn count_evaluation() {
    evaluations += 1u;
}

fn count_iterations(n: u32) {
    iterations += n;
}

/// Stores the work of the cell: that of this dispatch, and of those before for all samples.
fn counters_store(cell: u32) {
    let at = turn.stage.tally + 2u * cell;
    if turn.done > 0u || turn.stage.before > 0u {
        // Not beyond the largest number.
        evaluations += min(cells.words[at], 0xffffffffu - evaluations);
        iterations += min(cells.words[at + 1u], 0xffffffffu - iterations);
    }
    cells.words[at] = evaluations;
    cells.words[at + 1u] = iterations;
}
