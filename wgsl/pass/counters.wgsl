// Work counters: evaluations of the estimate and iterations of the formula in this invocation.
// The stand-in `base/counters_off.wgsl` is joined where work is not counted.

var<private> evaluations: u32 = 0u;
var<private> iterations: u32 = 0u;

fn count_evaluation() {
    evaluations += 1u;
}

fn count_iterations(n: u32) {
    iterations += n;
}

/// Adds this dispatch's work to that of the cell so far.
fn counters_store(cell: u32) {
    let at = turn.stage.tally + 2u * cell;
    cells[at] += evaluations;
    cells[at + 1u] += iterations;
}
