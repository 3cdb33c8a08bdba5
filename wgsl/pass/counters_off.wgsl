// The stand-in of `counters.wgsl` where work is not counted.

fn count_evaluation() {}

fn count_iterations(n: u32) {}

fn counters_store(cell: u32) {}
