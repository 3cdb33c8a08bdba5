//! Cone maps made on a device, equal to those from the CPU.

pub mod generate;
pub mod min3x3;
pub mod slopes;
