//! The GPU executor: the passes of a Plan in f32 on a wgpu device.
//!
//! - [`render`]: from a Plan to a Frame
//! - [`adapters`]: how a device is chosen and opened; [`device`]; [`buffer`]: typed buffers
//! - [`kernel`]: compiled programs; [`kernel_error`]: why one cannot be
//! - [`work`]: a render under way; `target`: its buffers and bound kernels; `cost`: how long
//!   its dispatches take; `stamps`: the device's own time
//! - `texts`: shader texts of a host, and what is used while one of them is wrong
//! - [`pick`]: what there is at a pixel or at a point
//! - `array`: arrays of the host on the device
//! - `staging`: read-back without waiting; `collect`: results into the Frame
//! - [`conemap`]: generators of cone maps on the device
//! - `background`: a task on its own thread, or `on_demand` where there are no threads;
//!   `task_status`: its progress
//! - [`wait`]: what waits for a device
//! - `error`: why a render failed

#[cfg(feature = "cli")]
pub mod adapters;
mod array;
#[cfg(feature = "cli")]
mod background;
#[cfg(not(feature = "cli"))]
#[path = "on_demand.rs"]
mod background;
pub mod buffer;
mod collect;
#[cfg(feature = "cli")]
pub mod conemap;
mod cost;
pub mod device;
mod error;
pub mod kernel;
pub mod kernel_error;
pub mod pick;
pub mod render;
mod staging;
mod stamps;
mod target;
mod task_status;
mod texts;
#[cfg(feature = "cli")]
pub mod wait;
pub mod work;

pub use error::RenderError;
