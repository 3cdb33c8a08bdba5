//! A render under way.
//!
//! A frame is a stream of submissions. Each holds dispatches of one or more stages, in order,
//! and is estimated to take at most [`SUBMISSION_MS`]. The host encodes ahead of what it
//! knows: on the device, `wgsl/pass/arrange.wgsl` decides what a dispatch visits, and a
//! dispatch of a stage that is not under way visits nothing. After each submission the host
//! learns how far the frame has come, without waiting for it, and corrects what it encodes
//! next. So neither the length of a submission nor a wrong estimate changes a bit.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use crate::gpu::array::Arrays;
use crate::gpu::collect::Parts;
use crate::gpu::cost::Cost;
use crate::gpu::device::Device;
use crate::gpu::error::RenderError;
use crate::gpu::kernel::Kernels;
use crate::gpu::staging::Staging;
use crate::gpu::stamps::{PAIR, Stamps};
use crate::gpu::target::Target;
use crate::heightfield::assets::Preparation;
use crate::pass::progress::{Progress, Watch};
use crate::pass::turn::{Layout, ListsHead, MOST_STAGES, Stage, Turn};
use crate::picture::frame::Frame;
use crate::plan::{Extras, Pass};

/// The longest estimated submission in milliseconds. A window that shares the device stays
/// fluid, and the device is free soon after a render was cancelled.
pub const SUBMISSION_MS: f64 = 40.0;
/// Submissions that the device may have at once: one runs, and one is next.
const IN_FLIGHT: usize = 2;
/// Bytes of a report: the turn, the head of the lists, and a pair of timestamps.
const REPORT: u64 = (size_of::<Turn>() + size_of::<ListsHead>()) as u64 + PAIR;

/// What the renders of a device share.
pub(super) struct Shared {
    pub device: Arc<Device>,
    pub kernels: Mutex<Kernels>,
    pub arrays: Mutex<Arrays>,
    pub kept: Mutex<Kept>,
}

/// What one render leaves to the next.
#[derive(Default)]
pub(super) struct Kept {
    pub target: Option<Target>,
    pub costs: Vec<Cost>,
    pub stamps: Option<Stamps>,
    pub reports: Vec<Staging>,
    pub readings: Vec<Staging>,
}

/// How the host and the device worked together on a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// How often the device had nothing to do until the host knew more.
    pub drains: u32,
    /// Submissions.
    pub submissions: u32,
    /// Bytes of parameters and scene data that were written.
    pub uploads: usize,
    /// Programs that were compiled.
    pub compilations: usize,
    /// Whether buffers were created and bound.
    pub allocated: bool,
}

/// What a render knows from the start.
pub(super) struct Job {
    pub passes: Vec<Pass>,
    pub blocks: Vec<Layout>,
    pub ray_steps: u32,
    /// The step limits of the first dispatch of a stage and of the largest.
    pub steps: [u32; 2],
    pub extras: Extras,
    pub prepared: Vec<(Preparation, f64)>,
}

/// A submission that has not ended, as far as the host knows.
struct Flight {
    index: wgpu::SubmissionIndex,
    report: Staging,
    /// Results of a block, if its last stage is in the submission.
    reading: Option<(usize, Staging)>,
    /// The first stage in it, and the stage that should be under way after it.
    stages: Range<u32>,
    /// Corrections that the host had made before.
    corrections: u32,
    submitted: Instant,
}

/// A render under way on a device. Dropping it cancels it.
pub struct Work {
    shared: Arc<Shared>,
    kept: Kept,
    job: Job,
    frame: Frame,
    /// The stage to encode next, and how many dispatches of it are to be encoded.
    cursor: u32,
    dispatches: u32,
    /// The stage under way on the device, as of the last report.
    reached: u32,
    /// Dispatches of each stage of the block under way, as of the last report.
    told: [u32; MOST_STAGES],
    flights: VecDeque<Flight>,
    corrections: u32,
    ended: Instant,
    /// Blocks in the frame.
    collected: usize,
    counters: Counters,
}

impl Work {
    pub(super) fn new(
        shared: Arc<Shared>,
        kept: Kept,
        job: Job,
        frame: Frame,
        counters: Counters,
    ) -> Self {
        let mut work = Self {
            shared,
            kept,
            job,
            frame,
            cursor: 0,
            dispatches: 0,
            reached: 0,
            told: [0; MOST_STAGES],
            flights: VecDeque::new(),
            corrections: 0,
            ended: Instant::now(),
            collected: 0,
            counters,
        };
        work.go_to(0);
        work
    }

    /// Stages of a block.
    fn per_block(&self) -> u32 {
        // A stage before the passes and one after.
        self.job.passes.len() as u32 + 2
    }

    fn end(&self) -> u32 {
        self.per_block() * self.job.blocks.len() as u32
    }

    /// The block of a stage, and the stage's position in it.
    fn place(&self, stage: u32) -> (usize, usize) {
        let n = self.per_block();
        ((stage / n) as usize, (stage % n) as usize)
    }

    /// The pass of a stage of a block, or the one next to it.
    fn pass_at(&self, index: usize) -> usize {
        index.clamp(1, self.job.passes.len()) - 1
    }

    /// The stages of a block, with what is known of their costs.
    fn stages(&self, block: usize) -> Vec<Stage> {
        let first = block as u32 * self.per_block();
        let layout = &self.job.blocks[block];
        let mut stages = layout.stages(&self.job.passes, first, self.job.ray_steps);
        for (stage, cost) in stages.iter_mut().zip(&self.kept.costs) {
            [stage.chunk, stage.most] = self.job.steps;
            stage.slice = cost.slice;
        }
        stages
    }

    /// Encodes from a stage on.
    fn go_to(&mut self, stage: u32) {
        self.cursor = stage;
        if stage < self.end() {
            let (block, index) = self.place(stage);
            let stage = self.stages(block)[index];
            self.dispatches = self.kept.costs[index].dispatches(&stage);
        }
    }

    /// How far the render has come.
    pub fn progress(&self) -> Progress {
        let (_, index) = self.place(self.reached.min(self.end() - 1));
        Progress {
            pass: self.job.passes[self.pass_at(index)].name(),
            done: f64::from(self.reached) / f64::from(self.end()),
        }
    }

    /// How the host and the device worked together so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Submits about so many milliseconds of work, but at most two submissions at once. It
    /// never waits.
    ///
    /// # Errors
    /// The device failed.
    pub fn advance(&mut self, budget_ms: f64) -> Result<(), RenderError> {
        self.receive()?;
        let mut left = budget_ms;
        while left > 0.0 && self.flights.len() < IN_FLIGHT && self.cursor < self.end() {
            left -= self.submit(left.min(SUBMISSION_MS));
        }
        Ok(())
    }

    /// The frame, once it is finished. It never waits.
    ///
    /// # Errors
    /// The device failed, or left cells unvisited.
    pub fn poll(&mut self) -> Result<Option<Frame>, RenderError> {
        self.receive()?;
        if self.collected < self.job.blocks.len() {
            return Ok(None);
        }
        let mut frame = std::mem::take(&mut self.frame);
        frame.finish(std::mem::take(&mut self.job.prepared));
        Ok(Some(frame))
    }

    /// Waits for the frame. `watch` is told of each pass that has ended.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`] if `watch` returns `false`. The device failed, or left cells
    /// unvisited.
    pub fn finish(mut self, watch: Watch<'_>) -> Result<Frame, RenderError> {
        let mut told = 0;
        loop {
            self.advance(f64::INFINITY)?;
            for stage in told..self.reached {
                let (_, index) = self.place(stage);
                // The stages about the passes are not told.
                if (1..=self.job.passes.len()).contains(&index) {
                    let passes = self.job.passes.len() * self.job.blocks.len();
                    let (block, _) = self.place(stage);
                    let done = block * self.job.passes.len() + index;
                    let progress = Progress {
                        pass: self.job.passes[index - 1].name(),
                        done: done as f64 / passes as f64,
                    };
                    if !watch(&progress) {
                        return Err(RenderError::Cancelled);
                    }
                    self.shared.device.check()?;
                }
            }
            told = self.reached;
            if let Some(frame) = self.poll()? {
                return Ok(frame);
            }
            if let Some(flight) = self.flights.front() {
                let index = Some(flight.index.clone());
                self.shared.device.wait_for(index)?;
            }
        }
    }

    /// Encodes and submits work of about so many milliseconds, of one block. Returns its
    /// estimated milliseconds.
    fn submit(&mut self, budget_ms: f64) -> f64 {
        let shared = self.shared.clone();
        let device = &shared.device;
        let (block, _) = self.place(self.cursor);
        let stages = self.stages(block);
        let first = self.cursor;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        let Some(target) = self.kept.target.as_ref() else {
            unreachable!("a work has a target");
        };
        target.write_stages(device, &stages);
        let stamps = self.kept.stamps.as_ref().filter(|_| self.job.extras.time);
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes: stamps.map(Stamps::writes),
        });
        let mut cursor = self.cursor;
        let mut estimate = 0.0;
        let mut ends_block = false;
        while estimate < budget_ms {
            let (_, index) = self.place(cursor);
            let bound = &target.stages[index];
            let each = self.kept.costs[index].dispatch_ms;
            let room = ((budget_ms - estimate) / each).max(1.0) as u32;
            let count = self.dispatches.min(room);
            for _ in 0..count {
                target
                    .arrange
                    .dispatch(&mut compute, &bound.arrange, [1, 1]);
                let workgroups = &target.workgroups;
                bound
                    .kernel
                    .dispatch_indirect(&mut compute, &bound.groups, workgroups);
            }
            estimate += f64::from(count) * each;
            self.dispatches -= count;
            if self.dispatches > 0 {
                break;
            }
            cursor += 1;
            ends_block = index + 1 == stages.len();
            let of_pass = self.job.passes.get(index.wrapping_sub(1));
            // Figures of a pass are those of its own submissions.
            let cut = self.job.extras.time || of_pass == Some(&Pass::Trace);
            if !ends_block {
                let next = &stages[index + 1];
                self.dispatches = self.kept.costs[index + 1].dispatches(next);
            }
            if ends_block || cut {
                break;
            }
        }
        target
            .arrange
            .dispatch(&mut compute, &target.settle, [1, 1]);
        drop(compute);
        let report = self.kept.reports.pop();
        let report = report.unwrap_or_else(|| Staging::new(device, REPORT));
        let (turn, head) = (size_of::<Turn>() as u64, size_of::<ListsHead>() as u64);
        let mut ranges = vec![(&target.turn, 0, turn), (&target.lists, 0, head)];
        if let Some(stamps) = stamps {
            stamps.resolve(&mut encoder);
            ranges.push((&stamps.pair, 0, PAIR));
        }
        report.copy(&mut encoder, &ranges);
        let reading = ends_block.then(|| {
            let parts = Parts::new(&self.job.blocks[block], self.job.extras);
            let kept = self.kept.readings.pop();
            let staging = kept.filter(|s| s.holds(parts.bytes()));
            let staging = staging.unwrap_or_else(|| Staging::new(device, parts.bytes()));
            staging.copy(&mut encoder, &parts.ranges(target));
            (block, staging)
        });
        let index = device.queue.submit([encoder.finish()]);
        report.map();
        if let Some((_, staging)) = &reading {
            staging.map();
        }
        self.counters.submissions += 1;
        self.flights.push_back(Flight {
            index,
            report,
            reading,
            stages: first..cursor,
            corrections: self.corrections,
            submitted: Instant::now(),
        });
        if ends_block {
            self.go_to(cursor);
        } else {
            self.cursor = cursor;
        }
        estimate
    }

    /// Takes in what has ended.
    fn receive(&mut self) -> Result<(), RenderError> {
        self.shared.device.check()?;
        let has_ended = |f: &Flight| {
            f.report.is_mapped() && f.reading.as_ref().is_none_or(|(_, s)| s.is_mapped())
        };
        while self.flights.front().is_some_and(has_ended) {
            let Some(flight) = self.flights.pop_front() else {
                break;
            };
            self.land(flight)?;
        }
        Ok(())
    }

    /// Takes in a submission that has ended.
    fn land(&mut self, flight: Flight) -> Result<(), RenderError> {
        let shared = self.shared.clone();
        let device = &shared.device;
        let turn: Vec<Turn> = flight.report.read(device, 0, 1)?;
        let head: Vec<ListsHead> = flight.report.read(device, size_of::<Turn>(), 1)?;
        let (turn, head) = (turn[0], head[0]);
        let pair: Vec<u64> = flight.report.read(device, (REPORT - PAIR) as usize, 2)?;
        flight.report.unmap();
        self.kept.reports.push(flight.report);
        let now = Instant::now();
        let started = flight.submitted.max(self.ended);
        let elapsed_ms = now.duration_since(started).as_secs_f64() * 1e3;
        self.ended = now;
        self.count_time(&flight.stages, elapsed_ms, [pair[0], pair[1]]);
        self.learn(&flight.stages, elapsed_ms, &head);
        self.reached = turn.number;
        if let Some((block, staging)) = flight.reading {
            if turn.number >= (block as u32 + 1) * self.per_block() && self.collected == block {
                self.collect(block, &staging, &head)?;
            }
            staging.unmap();
            self.kept.readings.push(staging);
        }
        // A submission from before a correction says nothing new.
        if turn.number < flight.stages.end && flight.corrections == self.corrections {
            self.corrections += 1;
            self.counters.drains += u32::from(self.flights.is_empty());
            self.go_to(turn.number);
        }
        Ok(())
    }

    /// Adds the time of a submission to the figures of its last pass.
    fn count_time(&mut self, stages: &Range<u32>, elapsed_ms: f64, pair: [u64; 2]) {
        let last = stages.end.max(stages.start + 1) - 1;
        let (_, index) = self.place(last);
        let at = self.pass_at(index);
        let figures = &mut self.frame.passes[at];
        figures.wall_ms += elapsed_ms;
        if let Some(stamps) = self.kept.stamps.as_ref().filter(|_| self.job.extras.time) {
            *figures.gpu_ms.get_or_insert(0.0) += stamps.milliseconds(pair);
        }
    }

    /// Learns from a submission how long dispatches take.
    fn learn(&mut self, stages: &Range<u32>, elapsed_ms: f64, head: &ListsHead) {
        let (block, first) = self.place(stages.start);
        let (_, last) = self.place(stages.end.max(stages.start + 1) - 1);
        let ran = |i: usize| head.dispatches[i].saturating_sub(self.told[i]);
        let all: u32 = (first..=last).map(ran).sum();
        let each = elapsed_ms / f64::from(all.max(1));
        let known = self.stages(block);
        for i in first..=last {
            if ran(i) > 0 {
                self.kept.costs[i].learn(each, head.dispatches[i], &known[i]);
            }
        }
        self.told = head.dispatches;
    }

    fn collect(
        &mut self,
        block: usize,
        staging: &Staging,
        head: &ListsHead,
    ) -> Result<(), RenderError> {
        let device = &self.shared.device;
        if head.wrong > 0 {
            return Err(RenderError::Unwritten {
                device: device.info.name.clone(),
                cells: head.wrong as usize,
            });
        }
        let layout = &self.job.blocks[block];
        let parts = Parts::new(layout, self.job.extras);
        parts.collect(device, staging, layout, &self.job.passes, &mut self.frame)?;
        self.collected += 1;
        Ok(())
    }
}

impl Drop for Work {
    /// Leaves everything to the next render. The device may still run what was submitted; the
    /// next render is behind it.
    fn drop(&mut self) {
        let mut kept = self
            .shared
            .kept
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *kept = std::mem::take(&mut self.kept);
    }
}
