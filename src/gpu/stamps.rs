//! The device's own time of the stages of a submission.

use crate::gpu::buffer::create;
use crate::gpu::device::Device;
use crate::pass::turn::MOST_STAGES;

/// Timestamps of a submission: its begin, and the end of each stage.
const COUNT: usize = MOST_STAGES + 1;
/// Their bytes.
pub const STAMPS: u64 = (COUNT * size_of::<u64>()) as u64;

/// Timestamps, one at the begin of a submission and one at the end of each stage in it.
pub struct Stamps {
    set: wgpu::QuerySet,
    /// Where they are resolved to.
    pub resolved: wgpu::Buffer,
    tick_ns: f32,
}

impl Stamps {
    /// `None` if the device has no timestamps.
    pub fn new(device: &Device) -> Option<Self> {
        let tick_ns = device.tick_ns?;
        let set = device.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("stamps"),
            ty: wgpu::QueryType::Timestamp,
            count: COUNT as u32,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        Some(Self {
            set,
            resolved: create(device, "stamps", STAMPS, usage),
            tick_ns,
        })
    }

    /// What the compute pass of a stage writes, the first of a submission being 0.
    pub fn writes(&self, nth: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: (nth == 0).then_some(0),
            end_of_pass_write_index: Some(nth + 1),
        }
    }

    /// Encodes the resolution of the timestamps of so many stages.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder, stages: u32) {
        encoder.resolve_query_set(&self.set, 0..stages + 1, &self.resolved, 0);
    }

    /// Milliseconds of each stage.
    #[allow(clippy::cast_precision_loss, reason = "a time for reading")]
    pub fn milliseconds(&self, stamps: &[u64]) -> Vec<f64> {
        let between = |pair: &[u64]| {
            let ticks = pair[1].saturating_sub(pair[0]);
            ticks as f64 * f64::from(self.tick_ns) * 1e-6
        };
        stamps.windows(2).map(between).collect()
    }
}
