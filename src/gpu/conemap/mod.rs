//! Cone maps from a device, equal to those from the CPU.
//!
//! - [`generate`]: the searches of a generator
//! - [`min3x3`]: the least cone of nine

pub mod generate;
pub mod min3x3;
