//! The GPU executor: choosing a device, typed buffers, compiled kernels, and rendering.

pub mod buffer;
pub mod collect;
pub mod conemap;
pub mod device;
mod dispatch;
mod error;
mod job;
pub mod kernel;
pub mod render;

pub use error::RenderError;
