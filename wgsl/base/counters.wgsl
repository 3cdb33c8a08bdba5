// Work counters: evaluations of the estimate and iterations of the formula in this invocation.
// The stand-in `base/counters_off.wgsl` is joined where work is not counted.

var<private> evaluations: u32 = 0u;
var<private> iterations: u32 = 0u;

/// Per cell: evaluations and iterations so far, summed over dispatches.
@group(2) @binding(9) var<storage, read_write> tally: array<vec2<u32>>;

fn count_evaluation() {
    evaluations += 1u;
}

fn count_iterations(n: u32) {
    iterations += n;
}

fn counters_store(cell: u32) {
    tally[cell] += vec2<u32>(evaluations, iterations);
}
