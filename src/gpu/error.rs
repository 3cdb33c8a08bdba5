//! Why a render failed.

use thiserror::Error;

use crate::gpu::device::DeviceError;
use crate::gpu::kernel::KernelError;
use crate::heightfield::conemap::generate::generator::GenerateError;
use crate::heightfield::tracer::settings::PrepareError;

/// Why a render failed.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The device failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A program failed.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// An asset of the scene could not be loaded or made.
    #[error(transparent)]
    Prepare(PrepareError),
    /// A buffer of the scene is too large for the device.
    #[error(
        "the device `{device}` binds at most {most} bytes at once, but the scene's `{what}` needs {needed}. Try {}, another --device, or --device cpu",
        smaller(.what)
    )]
    TooLarge {
        /// Its name.
        device: String,
        /// What is too large.
        what: &'static str,
        /// Its bytes.
        needed: u64,
        /// Bytes that the device allows.
        most: u64,
    },
    /// The watch cancelled the render.
    #[error("cancelled")]
    Cancelled,
    /// The device reported no error but left cells unvisited.
    #[error(
        "the device `{device}` left {cells} cells of pass `{pass}` unwritten and reported no error. Try a smaller --size, another --device, or --device cpu"
    )]
    Unwritten {
        /// Its name.
        device: String,
        /// The pass.
        pass: String,
        /// How many.
        cells: usize,
    },
}

impl From<PrepareError> for RenderError {
    fn from(error: PrepareError) -> Self {
        match error {
            PrepareError::Generate(GenerateError::Cancelled) => Self::Cancelled,
            PrepareError::Generate(GenerateError::Device(e)) => Self::Device(e),
            PrepareError::Generate(GenerateError::Kernel(e)) => Self::Kernel(e),
            other => Self::Prepare(other),
        }
    }
}

/// What makes a buffer of the scene smaller.
fn smaller(what: &str) -> &'static str {
    match what {
        "texels" => "a smaller scene.texture",
        _ => "a smaller height map",
    }
}
