//! The device's own time of a submission.

use crate::gpu::buffer::create;
use crate::gpu::device::Device;

/// Bytes of a pair of timestamps.
pub const PAIR: u64 = 16;

/// A pair of timestamps, written by one compute pass.
pub struct Stamps {
    set: wgpu::QuerySet,
    /// Where the pair is resolved to.
    pub pair: wgpu::Buffer,
    tick_ns: f32,
}

impl Stamps {
    /// `None` if the device has no timestamps.
    pub fn new(device: &Device) -> Option<Self> {
        let tick_ns = device.tick_ns?;
        let set = device.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("stamps"),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        Some(Self {
            set,
            pair: create(device, "stamps", PAIR, usage),
            tick_ns,
        })
    }

    /// What a compute pass writes at its begin and its end.
    pub fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Encodes the resolution of the pair.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.set, 0..2, &self.pair, 0);
    }

    /// Milliseconds between the two.
    #[allow(clippy::cast_precision_loss, reason = "a time for reading")]
    pub fn milliseconds(&self, pair: [u64; 2]) -> f64 {
        pair[1].saturating_sub(pair[0]) as f64 * f64::from(self.tick_ns) * 1e-6
    }
}
