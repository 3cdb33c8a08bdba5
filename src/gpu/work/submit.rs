//! Encoding and submission.

use crate::gpu::collect::Parts;
use crate::gpu::stamps::STAMPS;
use crate::pass::layout::CellsHead;
use crate::pass::turn::{StageKind, Turn};
use crate::plan::Pass;

use super::run::{Flight, REPORT, Run, SUBMISSION_MS};

impl Run {
    /// The first stage of the next submission. The last one may have held too few dispatches of a
    /// stage with rounds. The device goes on with that stage while the host learns of it, and need
    /// not wait.
    fn unsure_from(&self) -> u32 {
        let has_rounds = |stage: &u32| {
            let (block, index) = self.place(*stage);
            let is_march = matches!(self.job.kinds[index], StageKind::Pass(p) if p.marches());
            is_march && block == self.place(self.cursor).0
        };
        let last = self.flights.back().map(|flight| {
            let from = flight.stages.start.max(self.reached);
            (from..self.cursor).find(has_rounds)
        });
        last.flatten().unwrap_or(self.cursor)
    }

    /// Encodes and submits work of about so many milliseconds, of one block. Returns its
    /// estimated milliseconds.
    pub(super) fn submit(&mut self, budget_ms: f64) -> f64 {
        let shared = self.shared.clone();
        let device = &shared.device;
        let (block, _) = self.place(self.cursor);
        let stages = self.stages(block);
        let first = self.unsure_from();
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
        let mut dispatch = |index: usize, count: u32| {
            let bound = &target.stages[index];
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
        };
        let mut estimate = 0.0;
        // Something is done in each submission.
        let mut is_first = true;
        let mut room_for = |estimate: f64, each: f64, most: f64| {
            std::mem::take(&mut is_first) || estimate + each <= most
        };
        let mut all_unsure = true;
        for unsure in first..self.cursor {
            let (_, index) = self.place(unsure);
            let each = self.reusable.costs[index].longest_ms(&stages[index]);
            all_unsure = room_for(estimate, each, SUBMISSION_MS);
            if !all_unsure {
                break;
            }
            dispatch(index, 1);
            estimate += each;
        }
        let mut cursor = self.cursor;
        // Behind stages that may be over already, the first dispatch may exceed the budget, or the
        // device would have nothing to do.
        let mut most = budget_ms.max(SUBMISSION_MS);
        let mut ends_block = false;
        loop {
            let (_, index) = self.place(cursor);
            let each = self.reusable.costs[index].longest_ms(&stages[index]);
            let most = std::mem::replace(&mut most, budget_ms);
            if !all_unsure || !room_for(estimate, each, most) {
                break;
            }
            let room = ((budget_ms - estimate) / each).max(1.0) as u32;
            let count = self.dispatches.min(room);
            dispatch(index, count);
            estimate += f64::from(count) * each;
            self.dispatches -= count;
            if self.dispatches > 0 {
                break;
            }
            cursor += 1;
            ends_block = index + 1 == stages.len();
            let is_trace = self.job.kinds[index] == StageKind::Pass(Pass::Trace);
            // Without timestamps, the time of march and trace is that of their own submissions.
            let is_timed_alone = is_trace && self.job.extras.time && stamps.is_none();
            if !ends_block {
                let next = &stages[index + 1];
                self.dispatches = self.reusable.costs[index + 1].dispatches(next);
            }
            if ends_block || is_timed_alone {
                break;
            }
        }
        let stagings = &mut self.reusable.stagings;
        let made = stagings.made;
        let report = stagings.take(device, REPORT);
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
        let reads = ends_block && self.job.completes(block).is_some();
        let reading = reads.then(|| {
            let parts = Parts::new(&self.job.made.blocks[block], self.job.extras);
            let staging = stagings.take(device, parts.bytes());
            staging.copy(&mut encoder, &parts.ranges(target));
            (block, staging)
        });
        let _index = device.submit(encoder);
        report.map();
        if let Some((_, staging)) = &reading {
            staging.map();
        }
        let made = self.reusable.stagings.made - made;
        let traffic = self.traffic_mut();
        traffic.submissions += 1;
        traffic.allocations += made;
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
