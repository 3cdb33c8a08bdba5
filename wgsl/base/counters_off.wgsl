// The stand-in of `base/counters.wgsl` where work is not counted.

const COUNTS_WORK = false;

fn count_evaluation() {}

fn count_iterations(n: u32) {}

fn counted() -> vec2<u32> {
    return vec2<u32>(0u);
}
