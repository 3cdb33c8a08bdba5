// The empty stand-in of `base/counters.wgsl`.

fn count_evaluation() {}

fn count_iterations(n: u32) {}

fn counters_store(cell: u32) {}
