//! What waits for a device. A browser allows none of it.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use bytemuck::Pod;
use wgpu::BufferUsages;

use crate::gpu::buffer::{Buffer, bytes_for, create};
use crate::gpu::device::{Device, DeviceError};

/// A dispatch has a bounded number of steps, so a device that needs more seconds hangs.
const MOST_SECONDS: u32 = 120;

/// How long was waited for a device that does not answer.
#[derive(Debug, Default)]
pub struct Patience {
    since: f64,
    waited: f64,
}

impl Patience {
    /// Whether the device hangs, after one more wait. Both times are in milliseconds; `since` is when
    /// the work under way began. If the process or the whole machine sleeps, the wait takes longer, so
    /// it counts as a second at most.
    pub fn ends(&mut self, since: f64, waited: f64) -> bool {
        if since != self.since {
            *self = Self { since, waited: 0.0 };
        }
        self.waited += waited.min(1e3);
        self.waited > 1e3 * f64::from(MOST_SECONDS)
    }
}

impl Device {
    /// Waits until everything submitted has run.
    ///
    /// # Errors
    /// The device was lost or reported an error.
    pub fn wait(&self) -> Result<(), DeviceError> {
        let mut polled = Err(wgpu::PollError::Timeout);
        // If the process or the whole machine sleeps, only one of these seconds passes.
        for _ in 0..MOST_SECONDS {
            polled = self.device.poll(wgpu::PollType::Wait {
                submission_index: None,
                timeout: Some(Duration::from_secs(1)),
            });
            if !matches!(polled, Err(wgpu::PollError::Timeout)) {
                break;
            }
        }
        self.trouble()?;
        polled.map(|_| ()).map_err(|e| self.lost(e.to_string()))
    }

    /// Waits until everything submitted has run, or until `goes_on` denies. Other threads may submit
    /// meanwhile.
    ///
    /// # Errors
    /// The device was lost or reported an error.
    pub fn wait_beside(&self, mut goes_on: impl FnMut() -> bool) -> Result<(), DeviceError> {
        let (ran, has_run) = channel();
        self.queue.on_submitted_work_done(move || {
            // The other end may have stopped to wait.
            let _ = ran.send(());
        });
        self.check()?;
        // A lost device drops the sender.
        while let Err(RecvTimeoutError::Timeout) = has_run.recv_timeout(Duration::from_millis(1))
            && goes_on()
        {
            self.check()?;
        }
        self.check()
    }

    /// Waits until a submission has run, but for 20 ms at most.
    ///
    /// # Errors
    /// The device was lost or reported an error.
    pub fn wait_a_moment(&self, submission: wgpu::SubmissionIndex) -> Result<(), DeviceError> {
        let polled = self.device.poll(wgpu::PollType::Wait {
            submission_index: Some(submission),
            timeout: Some(Duration::from_millis(20)),
        });
        self.trouble()?;
        match polled {
            Ok(_) | Err(wgpu::PollError::Timeout) => Ok(()),
            Err(e) => Err(self.lost(e.to_string())),
        }
    }
}

impl<T: Pod> Buffer<T> {
    /// Waits for the device and reads the first `count` values.
    pub fn read(&self, device: &Device, count: usize) -> Result<Vec<T>, DeviceError> {
        let size = bytes_for::<T>(count.min(self.len));
        let staging = create(device, "staging", size, BufferUsages::MAP_READ);
        let mut encoder = device.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.raw, 0, &staging, 0, size);
        device.submit(encoder);
        let bytes = std::mem::size_of::<T>() * count.min(self.len);
        map(device, &staging, bytes)
    }
}

/// Waits for the device and reads the first bytes of a buffer that can be mapped. The buffer
/// stays mapped.
pub fn map<T: Pod>(
    device: &Device,
    staging: &wgpu::Buffer,
    bytes: usize,
) -> Result<Vec<T>, DeviceError> {
    // If this fails, `wait` or the range below reports it.
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    device.wait()?;
    let view = staging.get_mapped_range(..);
    let view = view.map_err(|e| device.lost(e.to_string()))?;
    Ok(bytemuck::pod_collect_to_vec(&view[..bytes]))
}

/// Waits for the device and reads a picture, row by row, four bytes to a pixel.
///
/// # Errors
/// The device failed.
pub fn read_picture(device: &Device, picture: &wgpu::Texture) -> Result<Vec<u8>, DeviceError> {
    let row = 4 * picture.width();
    let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let bytes = u64::from(pitch) * u64::from(picture.height());
    let staging = create(device, "picture", bytes, BufferUsages::MAP_READ);
    let mut encoder = device.device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(pitch),
        rows_per_image: None,
    };
    let to = wgpu::TexelCopyBufferInfo {
        buffer: &staging,
        layout,
    };
    encoder.copy_texture_to_buffer(picture.as_image_copy(), to, picture.size());
    device.submit(encoder);
    let padded: Vec<u8> = map(device, &staging, bytes as usize)?;
    let rows = padded.chunks(pitch as usize);
    Ok(rows.flat_map(|r| &r[..row as usize]).copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_that_sleeps_does_not_lose_patience() {
        let mut patience = Patience::default();
        assert!(!patience.ends(1.0, 1e6));
        assert!((0..119).all(|_| !patience.ends(1.0, 1e3)));
        // Other work begins anew.
        assert!((0..120).all(|_| !patience.ends(2.0, 1e3)));
        assert!(patience.ends(2.0, 1e3));
    }
}
