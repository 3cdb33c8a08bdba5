// Work counters: evaluations of the estimate and iterations of the formula in this invocation.
// The stand-in `base/counters_off.wgsl` is joined where work is not counted.

const COUNTS_WORK = true;

var<private> evaluations: u32 = 0u;
var<private> iterations: u32 = 0u;

fn count_evaluation() {
    evaluations += 1u;
}

fn count_iterations(n: u32) {
    iterations += n;
}

/// Evaluations and iterations so far.
fn counted() -> vec2<u32> {
    return vec2<u32>(evaluations, iterations);
}
