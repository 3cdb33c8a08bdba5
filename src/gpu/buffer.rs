//! Typed buffers.

use std::marker::PhantomData;

use bytemuck::Pod;
use wgpu::BufferUsages;

use crate::gpu::device::Device;

/// A storage buffer of `len` values of `T` on a device.
pub struct Buffer<T> {
    /// The wgpu buffer.
    pub raw: wgpu::Buffer,
    /// Number of values.
    pub len: usize,
    kind: PhantomData<T>,
}

/// A buffer of so many bytes, all zero.
pub fn create(device: &Device, name: &str, size: u64, usage: BufferUsages) -> wgpu::Buffer {
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
}

/// The size of a buffer in bytes, rounded up to the copy alignment.
pub(super) fn bytes_for<T>(len: usize) -> u64 {
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
