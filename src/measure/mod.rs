//! Measurements, for benchmarks only.
//!
//! - [`truth`]: the truth of a plan
//! - [`compare`]: the depth errors of a frame; [`flip`]: how different two pictures look
//! - [`mod@sharpness`]: how sharp a frame is
//! - [`calibrate`]: probes of an estimate that propose settings
//! - [`tracer_stats`]: what tracers of heightfields cost and miss

pub mod calibrate;
pub mod compare;
pub mod flip;
pub mod sharpness;
pub mod tracer_stats;
pub mod truth;
