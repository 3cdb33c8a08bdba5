//! Typed buffers.

use std::marker::PhantomData;

use bytemuck::Pod;
use wgpu::BufferUsages;

use crate::gpu::device::{Device, DeviceError};

/// A storage buffer of `len` values of `T` on a device.
pub struct Buffer<T> {
    /// The wgpu buffer.
    pub raw: wgpu::Buffer,
    /// Number of values.
    pub len: usize,
    kind: PhantomData<T>,
}

/// A buffer of so many bytes, all zero.
pub(super) fn create(device: &Device, name: &str, size: u64, usage: BufferUsages) -> wgpu::Buffer {
    device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(name),
        size,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

impl<T: Pod> Buffer<T> {
    /// A buffer of zeros.
    pub fn new(device: &Device, name: &str, len: usize) -> Self {
        let len = len.max(1);
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        Self::over(create(device, name, bytes_for::<T>(len), usage), len)
    }

    /// The first `len` values of an existing buffer.
    pub fn over(raw: wgpu::Buffer, len: usize) -> Self {
        Self {
            raw,
            len,
            kind: PhantomData,
        }
    }

    /// Overwrites the first values.
    pub fn write(&self, device: &Device, values: &[T]) {
        let bytes = bytemuck::cast_slice(values);
        device.queue.write_buffer(&self.raw, 0, bytes);
    }

    /// Waits for the device and reads the first `count` values.
    pub fn read(&self, device: &Device, count: usize) -> Result<Vec<T>, DeviceError> {
        let size = bytes_for::<T>(count.min(self.len));
        let staging = create(device, "staging", size, BufferUsages::MAP_READ);
        let mut encoder = device.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.raw, 0, &staging, 0, size);
        device.queue.submit([encoder.finish()]);
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

/// The size of a buffer in bytes, rounded up to the copy alignment.
fn bytes_for<T>(len: usize) -> u64 {
    let size = (std::mem::size_of::<T>() * len) as u64;
    size.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT)
}

/// A buffer of parameters, which shaders read as storage.
pub fn uniform(device: &Device, name: &str, bytes: &[u8]) -> wgpu::Buffer {
    let size = (bytes.len() as u64).next_multiple_of(16);
    let raw = create(device, name, size, BufferUsages::STORAGE);
    device.queue.write_buffer(&raw, 0, bytes);
    raw
}
