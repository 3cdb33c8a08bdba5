//! One dispatch with its results: how many cells it listed, and how long the device took.
//!
//! A round trip to a device costs about as much as a small level, so a dispatch is one
//! submission and one small buffer to read.

use crate::gpu::buffer::{create, map};
use crate::gpu::device::{Device, DeviceError};
use crate::gpu::kernel::Kernel;
use crate::pass::queue::COUNT_AT;

/// Offset of the two timestamps in the result. The two counts are before them.
const STAMPS_AT: u64 = 8;
/// Bytes of the result.
const TOLD: u64 = STAMPS_AT + 2 * STAMP;
/// Bytes of a timestamp.
const STAMP: u64 = 8;

/// Runs dispatches and reads their results.
pub struct Dispatcher {
    queries: Option<(wgpu::QuerySet, wgpu::Buffer)>,
    told: wgpu::Buffer,
}

/// Lists that a dispatch fills.
pub struct Filled<'a> {
    /// Cells that still move.
    pub moving: &'a wgpu::Buffer,
    /// Cells whose children the next pass visits.
    pub parents: &'a wgpu::Buffer,
}

/// The result of a dispatch.
#[derive(Clone, Copy, Debug)]
pub struct Told {
    /// Cells that still move.
    pub moving: u32,
    /// Cells of this pass that are listed for the next one so far.
    pub parents: u32,
    /// Nanoseconds on the device, if it has timestamps and they were asked for.
    pub ns: Option<f64>,
}

impl Dispatcher {
    /// A dispatcher of a device.
    pub fn new(device: &Device) -> Self {
        let queries = device.tick_ns.map(|_| {
            let set = device.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("passes"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            });
            let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
            (set, create(device, "timestamps", 2 * STAMP, usage))
        });
        Self {
            queries,
            told: create(device, "told", TOLD, wgpu::BufferUsages::MAP_READ),
        }
    }

    /// Runs so many workgroups of a kernel and waits for them. The list of moving cells is
    /// emptied before, the list of parents grows.
    pub fn run(
        &self,
        device: &Device,
        kernel: &Kernel,
        groups: &[wgpu::BindGroup],
        count: [u32; 2],
        filled: &Filled<'_>,
        timed: bool,
    ) -> Result<Told, DeviceError> {
        let mut encoder = device.device.create_command_encoder(&Default::default());
        clear_count(&mut encoder, filled.moving);
        let queries = self.queries.as_ref().filter(|_| timed);
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes: queries.map(|(set, _)| wgpu::ComputePassTimestampWrites {
                query_set: set,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: Some(1),
            }),
        });
        kernel.dispatch(&mut compute, groups, count);
        drop(compute);
        encoder.copy_buffer_to_buffer(filled.moving, COUNT_AT, &self.told, 0, 4);
        encoder.copy_buffer_to_buffer(filled.parents, COUNT_AT, &self.told, 4, 4);
        if let Some((set, stamps)) = queries {
            encoder.resolve_query_set(set, 0..2, stamps, 0);
            encoder.copy_buffer_to_buffer(stamps, 0, &self.told, STAMPS_AT, 2 * STAMP);
        }
        device.queue.submit([encoder.finish()]);
        let told: Vec<u32> = map(device, &self.told, TOLD as usize)?;
        self.told.unmap();
        let stamp = |at: usize| u64::from(told[at]) | (u64::from(told[at + 1]) << 32);
        let tick = device.tick_ns.filter(|_| queries.is_some());
        let ns = tick.map(|tick| stamp(4).saturating_sub(stamp(2)) as f64 * f64::from(tick));
        Ok(Told {
            moving: told[0],
            parents: told[1],
            ns,
        })
    }
}

/// Empties a list.
pub fn clear_count(encoder: &mut wgpu::CommandEncoder, list: &wgpu::Buffer) {
    encoder.clear_buffer(list, COUNT_AT, Some(4));
}
