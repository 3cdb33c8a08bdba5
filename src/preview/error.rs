//! Why a preview cannot begin or go on.

use thiserror::Error;

use crate::gpu::device::DeviceError;

/// Why a preview cannot begin or go on.
#[derive(Debug, Error)]
pub enum PreviewError {
    /// There is no display.
    #[error(
        "no window opens ({0}); a preview needs a display: set DISPLAY or WAYLAND_DISPLAY, or use `render`, which needs none"
    )]
    Display(String),
    /// No adapter can draw to the window.
    #[error(
        "no adapter can show pictures in this window ({0}); on Linux, Mesa's drivers (mesa-vulkan-drivers) can, or use `render`"
    )]
    Adapter(String),
    /// The surface of the window is gone.
    #[error("the device `{0}` cannot draw to the window any more; start the preview again")]
    Surface(String),
    /// The device failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
}
