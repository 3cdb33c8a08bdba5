// The stand-in of `pass/counters.wgsl` where work is not counted.

fn count_evaluation() {}

fn count_iterations(n: u32) {}

fn counters_store(cell: u32) {}
