//! Why a device has no result.

use thiserror::Error;

use crate::base::units::{bytes_available, bytes_needed};
use crate::gpu::device::DeviceError;
use crate::gpu::kernel_error::KernelError;
use crate::heightfield::conemap::generate::generator::GenerateError;
use crate::heightfield::tracer::settings::PrepareError;
use crate::pass::prepare::FrameError;

/// Why there is no frame, or no cone map.
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
    /// A buffer is larger than the device allows.
    #[error(
        "the device `{device}` binds at most {} at once, and `{what}` needs {}; try {}, another --device, or --device cpu",
        bytes_available(*.most), bytes_needed(*.needed), smaller(.what)
    )]
    TooLarge {
        /// Its name.
        device: String,
        /// The buffer.
        what: String,
        /// Bytes that it needs.
        needed: u64,
        /// Bytes that the device allows.
        most: u64,
    },
    /// The watch cancelled the render.
    #[error("cancelled")]
    Cancelled,
    /// The thread that prepared the frame has panicked.
    #[error("the preparation of the frame has panicked; this is a fault of conemarch")]
    Panicked,
    /// The device reported no error but left cells unvisited.
    #[error(
        "the device `{device}` left {cells} cells unwritten and reported no error. Try a smaller --size, another --device, or --device cpu"
    )]
    Unwritten {
        /// Its name.
        device: String,
        /// How many.
        cells: usize,
    },
    /// The device ended a dispatch of a cone map that never began.
    #[error(
        "the device `{0}` made no progress on a cone map and reported no error; try another --device, or --device cpu"
    )]
    Stuck(String),
}

impl From<PrepareError> for RenderError {
    fn from(error: PrepareError) -> Self {
        match error {
            PrepareError::Generate(GenerateError::Cancelled) => Self::Cancelled,
            PrepareError::Generate(GenerateError::Device(e)) => match e.downcast::<Self>() {
                Ok(own) => *own,
                Err(e) => Self::Prepare(GenerateError::Device(e).into()),
            },
            other => Self::Prepare(other),
        }
    }
}

impl From<FrameError> for RenderError {
    fn from(error: FrameError) -> Self {
        match error {
            FrameError::Prepare(error) => error.into(),
            FrameError::Cancelled => Self::Cancelled,
        }
    }
}

impl From<RenderError> for GenerateError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Cancelled => Self::Cancelled,
            error => Self::Device(error.into()),
        }
    }
}

/// Checks that a device which binds at most so many bytes has room for a buffer.
///
/// # Errors
/// It does not.
pub(crate) fn check_room(
    device: &str,
    what: &str,
    needed: u64,
    most: u64,
) -> Result<(), RenderError> {
    if needed <= most {
        return Ok(());
    }
    Err(RenderError::TooLarge {
        device: device.into(),
        what: what.into(),
        needed,
        most,
    })
}

/// What would make a buffer smaller.
fn smaller(what: &str) -> &'static str {
    match what {
        "texels" => "a smaller scene.texture",
        "cells" | "walks" | "stages" => "a smaller size",
        _ => "a smaller height map",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_device_has_no_room_for_is_told() {
        const MOST: u64 = 1 << 27;
        // Half the cones of four sides over 4096 x 4096 samples fit to the byte.
        assert!(check_room("d", "ratios", 4096 * 4096 * 2 * 4, MOST).is_ok());
        let said = check_room("d", "maxima", MOST + 4, MOST)
            .expect_err("no room")
            .to_string();
        assert_eq!(
            said,
            "the device `d` binds at most 128 MiB at once, and `maxima` needs 128.1 MiB; try a smaller height map, another --device, or --device cpu"
        );
    }
}
