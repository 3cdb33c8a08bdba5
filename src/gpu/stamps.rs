//! The device's own time of the stages of a submission.

use crate::gpu::buffer::create;
use crate::gpu::device::Device;
use crate::pass::turn::MOST_STAGES;

/// A timestamp at the begin of a stage, and one at its end.
pub type Pair = [u64; 2];

/// Bytes of the pairs of all stages of a submission.
pub const PAIRS: u64 = (MOST_STAGES * size_of::<Pair>()) as u64;

/// Pairs of timestamps, one for each stage of a submission.
pub struct Stamps {
    set: wgpu::QuerySet,
    /// Where the pairs are resolved to.
    pub pairs: wgpu::Buffer,
    tick_ns: f32,
}

impl Stamps {
    /// `None` if the device has no timestamps.
    pub fn new(device: &Device) -> Option<Self> {
        let tick_ns = device.tick_ns?;
        let set = device.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("stamps"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * MOST_STAGES as u32,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        Some(Self {
            set,
            pairs: create(device, "stamps", PAIRS, usage),
            tick_ns,
        })
    }

    /// What the compute pass of a stage writes, the first of a submission being 0.
    pub fn writes(&self, nth: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(2 * nth),
            end_of_pass_write_index: Some(2 * nth + 1),
        }
    }

    /// Encodes the resolution of so many pairs.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder, count: u32) {
        encoder.resolve_query_set(&self.set, 0..2 * count, &self.pairs, 0);
    }

    /// Milliseconds between the two timestamps of a pair.
    #[allow(clippy::cast_precision_loss, reason = "a time for reading")]
    pub fn milliseconds(&self, pair: Pair) -> f64 {
        pair[1].saturating_sub(pair[0]) as f64 * f64::from(self.tick_ns) * 1e-6
    }
}
