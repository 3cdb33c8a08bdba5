//! What only benchmarks use: the truth, comparisons with it, and probes of estimates.

pub mod calibrate;
pub mod compare;
pub mod flip;
pub mod tracer_stats;
pub mod truth;
