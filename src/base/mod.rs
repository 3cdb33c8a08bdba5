//! The ground that all other rooms stand on.
//!
//! - [`mod@array`]: arrays of numbers that a device keeps from frame to frame
//! - [`key`]: the keys of presets
//! - [`shader`]: WGSL programs joined from files
//! - [`view`]: the camera's rays and cones, in each [`projection`]: `perspective`, `orthographic`,
//!   `fisheye` and `equirectangular`; `angle`: its cosine and sine
//! - [`cone`]: how far an empty ball carries a cone
//! - [`outcome`]: what a pixel is, and what it cost
//! - [`filter`]: where the samples of a pixel are; [`random`]: numbers for their light
//! - [`srgb`], [`oklab`]: linear colours to and from sRGB and Oklab
//! - [`one_value_cache`]: the last value that took long to make
//! - [`named`]: enums whose variants are chosen by a word
//! - [`mod@clock`]: time; [`parallel`]: work over all cores
//! - [`lanes`]: numbers of several points side by side
//! - [`units`]: amounts of memory for people to read

mod angle;
pub mod array;
pub mod clock;
pub mod cone;
mod equirectangular;
pub mod filter;
mod fisheye;
pub mod key;
pub mod lanes;
pub mod named;
pub mod oklab;
pub mod one_value_cache;
mod orthographic;
pub mod outcome;
pub mod parallel;
mod perspective;
pub mod projection;
pub mod random;
pub mod shader;
pub mod srgb;
pub mod units;
pub mod view;
