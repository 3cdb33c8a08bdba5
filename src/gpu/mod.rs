//! The GPU executor: the passes of a Plan in f32 on a wgpu device.
//!
//! - [`render`]: from a Plan to a Frame
//! - [`device`]: adapters and devices; [`buffer`]: typed buffers; [`kernel`]: compiled programs
//! - `job`: the numbers of a pass; `dispatch`: one dispatch; [`collect`]: results into the Frame
//! - [`conemap`]: generators of cone maps on the device
//! - `error`: why a render failed

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
