//! Encoding and submission.

use crate::gpu::collect::Parts;
use crate::gpu::staging::Staging;
use crate::gpu::stamps::STAMPS;
use crate::pass::turn::{CellsHead, StageKind, Turn};
use crate::plan::Pass;

use super::run::{Flight, REPORT, Run};

impl Run {
    /// Encodes and submits work of about so many milliseconds, of one block. Returns its
    /// estimated milliseconds.
    pub(super) fn submit(&mut self, budget_ms: f64) -> f64 {
        let shared = self.shared.clone();
        let device = &shared.device;
        let (block, _) = self.place(self.cursor);
        let stages = self.stages(block);
        let first = self.cursor;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        if let Some(target) = &mut self.reusable.target {
            target.write_stages(device, &stages);
        }
        let Some(target) = self.reusable.target.as_ref() else {
            unreachable!("a work has a target");
        };
        let stamps = self
            .reusable
            .stamps
            .as_ref()
            .filter(|_| self.job.extras.time);
        let mut encoded = 0;
        let mut cursor = self.cursor;
        let mut estimate = 0.0;
        let mut ends_block = false;
        while estimate < budget_ms {
            let (_, index) = self.place(cursor);
            let bound = &target.stages[index];
            let each = self.reusable.costs[index].dispatch_ms;
            let room = ((budget_ms - estimate) / each).max(1.0) as u32;
            let count = self.dispatches.min(room);
            let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: None,
                timestamp_writes: stamps.map(|s| s.writes(encoded)),
            });
            encoded += 1;
            for _ in 0..count {
                target
                    .arrange
                    .dispatch(&mut compute, &bound.arrange, [1, 1]);
                let workgroups = &target.shared.workgroups;
                bound
                    .kernel
                    .dispatch_indirect(&mut compute, &bound.groups, workgroups);
            }
            drop(compute);
            estimate += f64::from(count) * each;
            self.dispatches -= count;
            if self.dispatches > 0 {
                break;
            }
            cursor += 1;
            ends_block = index + 1 == stages.len();
            let is_trace = self.job.kinds[index] == StageKind::Pass(Pass::Trace);
            if !ends_block {
                let next = &stages[index + 1];
                self.dispatches = self.reusable.costs[index + 1].dispatches(next);
            }
            // The time of march and trace is that of their own submissions.
            if ends_block || is_trace {
                break;
            }
        }
        let report = self.reusable.reports.pop();
        let report = report.unwrap_or_else(|| Staging::new(device, REPORT));
        let (turn, head) = (size_of::<Turn>() as u64, size_of::<CellsHead>() as u64);
        let mut ranges = vec![
            (&target.shared.turn, 0, turn),
            (&target.shared.cells, 0, head),
        ];
        if let Some(stamps) = stamps {
            stamps.resolve(&mut encoder, encoded);
            ranges.push((&stamps.resolved, 0, STAMPS));
        }
        report.copy(&mut encoder, &ranges);
        let reads = ends_block && block >= self.job.firsts;
        let reading = reads.then(|| {
            let parts = Parts::new(&self.job.made.blocks[block], self.job.extras);
            let kept = self.reusable.readings.pop();
            let staging = kept.filter(|s| s.holds(parts.bytes()));
            // A buffer cannot be empty.
            let bytes = parts.bytes().max(16);
            let staging = staging.unwrap_or_else(|| Staging::new(device, bytes));
            staging.copy(&mut encoder, &parts.ranges(target));
            (block, staging)
        });
        let _index = device.queue.submit([encoder.finish()]);
        report.map();
        if let Some((_, staging)) = &reading {
            staging.map();
        }
        self.traffic_mut().submissions += 1;
        self.flights.push_back(Flight {
            #[cfg(feature = "cli")]
            index: _index,
            report,
            reading,
            stages: first..cursor,
            encoded,
            corrections: self.corrections,
            submitted: (device.clock)(),
        });
        if ends_block {
            self.go_to(cursor);
        } else {
            self.cursor = cursor;
        }
        estimate
    }
}
