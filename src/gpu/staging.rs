//! Read-back without waiting: a buffer is filled by a submission and mapped when that has run.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use bytemuck::Pod;
use wgpu::BufferUsages;

use crate::gpu::buffer::create;
use crate::gpu::device::{Device, DeviceError};

/// A buffer that the host can read.
pub struct Staging {
    buffer: wgpu::Buffer,
    mapped: Arc<AtomicBool>,
}

impl Staging {
    /// A buffer of so many bytes.
    pub fn new(device: &Device, bytes: u64) -> Self {
        Self {
            buffer: create(device, "staging", bytes.max(4), BufferUsages::MAP_READ),
            mapped: Arc::default(),
        }
    }

    /// Encodes copies of ranges, one after the other. Each range is a buffer, an offset and a
    /// number of bytes.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder, ranges: &[(&wgpu::Buffer, u64, u64)]) {
        let mut at = 0;
        for &(from, offset, bytes) in ranges {
            if bytes > 0 {
                encoder.copy_buffer_to_buffer(from, offset, &self.buffer, at, bytes);
            }
            at += bytes;
        }
    }

    /// Asks for the bytes. Call it after the copies were submitted.
    pub fn map(&self) {
        let mapped = self.mapped.clone();
        // A failure is reported by the device, and the range below is empty.
        self.buffer.map_async(wgpu::MapMode::Read, .., move |_| {
            mapped.store(true, Ordering::Release);
        });
    }

    /// Whether the bytes have arrived.
    pub fn is_mapped(&self) -> bool {
        self.mapped.load(Ordering::Acquire)
    }

    /// The bytes that have arrived.
    ///
    /// # Errors
    /// The device was lost.
    pub fn view(&self, device: &Device) -> Result<wgpu::BufferView, DeviceError> {
        let view = self.buffer.get_mapped_range(..);
        view.map_err(|e| device.lost(e.to_string()))
    }

    /// Values from an offset in bytes on.
    ///
    /// # Errors
    /// The device was lost.
    pub fn read<T: Pod>(
        &self,
        device: &Device,
        at: usize,
        count: usize,
    ) -> Result<Vec<T>, DeviceError> {
        let view = self.view(device)?;
        Ok(bytemuck::pod_collect_to_vec(
            &view[at..at + count * size_of::<T>()],
        ))
    }

    /// Frees the buffer for the next copies.
    fn unmap(&self) {
        self.mapped.store(false, Ordering::Release);
        self.buffer.unmap();
    }
}

/// Buffers for reading back, which many frames use.
#[derive(Default)]
pub struct Stagings {
    free: Vec<Staging>,
    /// Those that submissions of discarded frames still fill: reports, and what is read of a block.
    discarded: Vec<(Staging, Option<Staging>)>,
    /// How many were made.
    pub made: u32,
}

impl Stagings {
    /// How many submissions of discarded frames have not ended.
    pub fn behind(&mut self) -> usize {
        for (report, reading) in std::mem::take(&mut self.discarded) {
            let all = [&report].into_iter().chain(&reading);
            if all.into_iter().all(Staging::is_mapped) {
                self.put(report);
                reading.into_iter().for_each(|staging| self.put(staging));
            } else {
                self.discarded.push((report, reading));
            }
        }
        self.discarded.len()
    }

    /// Those alone that submissions of discarded frames still fill.
    pub fn into_behind(self) -> Self {
        Self {
            discarded: self.discarded,
            ..Self::default()
        }
    }

    /// A buffer of at least so many bytes: the smallest that is free, or a new one.
    pub fn take(&mut self, device: &Device, bytes: u64) -> Staging {
        self.behind();
        let size = |i: &usize| self.free[*i].buffer.size();
        let fitting = (0..self.free.len()).filter(|i| size(i) >= bytes);
        match fitting.min_by_key(size) {
            Some(i) => self.free.swap_remove(i),
            None => {
                self.made += 1;
                Staging::new(device, bytes)
            }
        }
    }

    /// Takes back a buffer that was read.
    pub fn put(&mut self, staging: Staging) {
        staging.unmap();
        self.free.push(staging);
    }

    /// Takes back the buffers of a submission that nobody will read.
    pub fn discard(&mut self, report: Staging, reading: Option<Staging>) {
        self.discarded.push((report, reading));
    }
}
