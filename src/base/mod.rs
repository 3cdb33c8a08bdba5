//! The ground that all other rooms stand on.
//!
//! - [`mod@array`]: arrays of numbers that a device keeps from frame to frame
//! - [`key`]: the keys of presets
//! - [`shader`]: WGSL programs joined from files
//! - [`view`]: the camera's rays and cones
//! - [`cone`]: how far an empty ball carries a cone
//! - [`outcome`]: what a pixel is, and what it cost
//! - [`srgb`]: linear colours to and from sRGB
//! - [`named`]: enums whose variants are chosen by a word
//! - [`mod@clock`]: time; [`parallel`]: work over all cores
//! - [`units`]: amounts of memory for people to read

pub mod array;
pub mod clock;
pub mod cone;
pub mod filter;
pub mod key;
pub mod named;
pub mod oklab;
pub mod outcome;
pub mod parallel;
pub mod shader;
pub mod srgb;
pub mod units;
pub mod view;
