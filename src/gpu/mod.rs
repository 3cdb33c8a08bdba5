//! The GPU floor: choosing a device, typed buffers, compiled kernels.

pub mod buffer;
pub mod device;
pub mod kernel;
