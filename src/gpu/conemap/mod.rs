//! Cone maps from a device, equal to those from the CPU.

pub mod generate;
pub mod min3x3;
