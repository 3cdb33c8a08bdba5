//! Why there is no frame.

use thiserror::Error;

use crate::gpu::device::DeviceError;
use crate::gpu::kernel::KernelError;
use crate::heightfield::conemap::generate::generator::GenerateError;
use crate::heightfield::tracer::settings::PrepareError;

/// Why there is no frame.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The device failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A program failed.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// What the scene needs could not be made.
    #[error(transparent)]
    Prepare(PrepareError),
    /// Something that the scene brings has no room in a buffer of the device.
    #[error(
        "the device `{device}` binds at most {most} bytes at once, and `{what}` of the scene needs {needed}; {}, another --device, or --device cpu would do",
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
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// The device claims to be done, but cells were never visited.
    #[error(
        "the device `{device}` left {cells} cells of pass `{pass}` unwritten and reported no error; try a smaller --size, another --device, or --device cpu"
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

/// What would be smaller in a buffer of the scene.
fn smaller(what: &str) -> &'static str {
    match what {
        "texels" => "a smaller scene.texture",
        _ => "a smaller height map",
    }
}
