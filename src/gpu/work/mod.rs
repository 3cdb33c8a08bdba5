//! A render under way.
//!
//! A frame is a stream of submissions. Each holds dispatches of one or more stages, in order,
//! and is estimated to take at most [`SUBMISSION_MS`]. The host encodes ahead of what it
//! knows: on the device, `wgsl/pass/arrange.wgsl` decides what a dispatch visits, and a
//! dispatch of a stage that is not under way visits nothing. After each submission the host
//! learns how far the frame has come, without waiting for it, and corrects what it encodes
//! next. So neither the length of a submission nor a wrong estimate changes a bit.

mod receive;
mod submit;

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::gpu::array::Arrays;
use crate::gpu::cost::{Cost, LONGEST_MS};
use crate::gpu::device::Device;
use crate::gpu::error::RenderError;
use crate::gpu::kernel::Kernels;
use crate::gpu::staging::Staging;
use crate::gpu::stamps::{PAIRS, Stamps};
use crate::gpu::target::{Parameters, Target, read_picture};
use crate::heightfield::assets::Preparation;
use crate::pass::progress::{Progress, Watch};
use crate::pass::turn::{Layout, ListsHead, MOST_STAGES, Stage, StageKind, Turn};
use crate::picture::frame::{Frame, Traffic};
use crate::plan::{Extras, Pass};

/// The longest estimated submission in milliseconds. A window that shares the device stays
/// fluid, and the device is free soon after a render was cancelled.
pub const SUBMISSION_MS: f64 = 40.0;
/// Submissions that the device may have at once: one runs, and one is next.
const IN_FLIGHT: usize = 2;
/// Bytes of a report: the turn, the head of the lists, and timestamps.
const REPORT: u64 = (size_of::<Turn>() + size_of::<ListsHead>()) as u64 + PAIRS;

/// What the renders of a device share.
pub(super) struct Shared {
    pub device: Arc<Device>,
    pub kernels: Mutex<Kernels>,
    pub arrays: Mutex<Arrays>,
    pub kept: Mutex<Kept>,
}

/// What a frame is made of, as far as that may stay when the look changes. The scene's arrays,
/// the programs and the sizes of a target stay anyway.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Made {
    pub passes: Vec<Pass>,
    pub blocks: Vec<Layout>,
    pub ray_steps: u32,
    /// Parameters of cones and rays.
    pub marched: Parameters,
    /// Parameters of the colours.
    pub look: Vec<u8>,
}

impl Made {
    /// The stage of a block from which a frame goes on after a finished one, if it can.
    fn resumes(&self, last: &Self, kinds: &[StageKind]) -> Option<u32> {
        let same_rays = Self {
            look: last.look.clone(),
            ..self.clone()
        } == *last;
        // The buffers hold one block.
        if !same_rays || self.blocks.len() > 1 {
            return None;
        }
        let after = |pass: Pass| kinds.iter().position(|k| *k == StageKind::Pass(pass));
        let color = after(Pass::Color)?;
        Some(color as u32 + u32::from(self.look == last.look))
    }
}

/// What one render leaves to the next.
#[derive(Default)]
pub(super) struct Kept {
    pub target: Option<Target>,
    pub costs: Vec<Cost>,
    /// Milliseconds that dispatches are made for.
    pub aim_ms: f64,
    pub stamps: Option<Stamps>,
    pub reports: Vec<Staging>,
    pub readings: Vec<Staging>,
    /// What the last frame was made of, if it was finished.
    pub made: Option<Made>,
}

/// What a render knows from the start.
pub(super) struct Job {
    pub kinds: Vec<StageKind>,
    pub made: Made,
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
    /// How many stages have dispatches in it.
    encoded: u32,
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
    /// The stage under way on the device, as of the last report, and the share of it that is
    /// done, about.
    reached: u32,
    share: f64,
    /// Dispatches of each stage of the block under way, as of the last report.
    told: [u32; MOST_STAGES],
    flights: VecDeque<Flight>,
    corrections: u32,
    ended: Instant,
    /// Blocks in the frame.
    collected: usize,
}

impl Work {
    pub(super) fn new(shared: Arc<Shared>, kept: Kept, job: Job, frame: Frame) -> Self {
        let mut work = Self {
            shared,
            kept,
            job,
            frame,
            cursor: 0,
            dispatches: 0,
            reached: 0,
            share: 0.0,
            told: [0; MOST_STAGES],
            flights: VecDeque::new(),
            corrections: 0,
            ended: Instant::now(),
            collected: 0,
        };
        let last = work.kept.made.take().filter(|_| work.job.extras.reuse);
        let first = last.and_then(|last| work.job.made.resumes(&last, &work.job.kinds));
        work.reached = first.unwrap_or(0);
        let blocks = work.job.made.blocks.len();
        let device = &work.shared.device;
        match (&mut work.kept.target, first) {
            (Some(target), Some(first)) => target.resume(device, first),
            (Some(target), None) => target.begin(device, blocks),
            (None, _) => {}
        }
        work.go_to(work.reached);
        work
    }

    /// Stages of a block.
    fn per_block(&self) -> u32 {
        self.job.kinds.len() as u32
    }

    fn end(&self) -> u32 {
        self.per_block() * self.job.made.blocks.len() as u32
    }

    /// The block of a stage, and the stage's position in it.
    fn place(&self, stage: u32) -> (usize, usize) {
        let n = self.per_block();
        ((stage / n) as usize, (stage % n) as usize)
    }

    /// The pass that a stage of a block is or follows; before the first one, the first.
    fn pass_at(&self, index: usize) -> usize {
        let stages = &self.job.kinds[..=index];
        let passes = stages.iter().filter(|k| matches!(k, StageKind::Pass(_)));
        passes.count().max(1) - 1
    }

    /// The number of a block, which tells its states from older ones.
    fn generation(&self, block: usize) -> u32 {
        let later = self.job.made.blocks.len() - 1 - block;
        let target = self.kept.target.as_ref();
        target.map_or(0, |target| target.generation(later))
    }

    /// The stages of a block, with what is known of their costs.
    fn stages(&self, block: usize) -> Vec<Stage> {
        let first = block as u32 * self.per_block();
        let layout = &self.job.made.blocks[block];
        let mut stages = layout.stages(&self.job.kinds, first, self.job.made.ray_steps);
        for (stage, cost) in stages.iter_mut().zip(&self.kept.costs) {
            [stage.chunk, stage.most] = self.job.steps;
            stage.slice = cost.slice;
            stage.generation = self.generation(block);
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
        self.progress_at(self.reached, self.share)
    }

    /// The progress when a stage is under way of which a share is done.
    fn progress_at(&self, stage: u32, share: f64) -> Progress {
        let is_pass = |k: &&StageKind| matches!(k, StageKind::Pass(_));
        let (block, index) = self.place(stage);
        let before = self.job.kinds[..index].iter().filter(is_pass).count();
        let passes = self.job.made.passes.len();
        let share = match self.job.kinds[index] {
            StageKind::Pass(_) => share,
            _ => 0.0,
        };
        let done = (block * passes + before) as f64 + share;
        Progress {
            pass: self.job.made.passes[self.pass_at(index)].name(),
            done: (done / (passes * self.job.made.blocks.len()) as f64).min(1.0),
        }
    }

    /// The picture as far as it is made: first the fronts of the coarse levels, then colours.
    /// `None` without [`Extras::shown`], or if the image is larger than a texture can be. Its
    /// bytes are those of sRGB, as files hold them.
    pub fn picture(&self) -> Option<&wgpu::Texture> {
        self.kept.target.as_ref()?.picture.as_ref()
    }

    /// Waits for the device and reads the picture, row by row, four bytes to a pixel.
    ///
    /// # Errors
    /// The device failed.
    pub fn pixels(&self) -> Result<Vec<u8>, RenderError> {
        let picture = self.picture();
        let read = picture.map(|picture| read_picture(&self.shared.device, picture));
        Ok(read.transpose()?.unwrap_or_default())
    }

    /// How the host and the device worked together so far.
    pub fn traffic(&self) -> Traffic {
        self.frame.traffic.unwrap_or_default()
    }

    /// Submits about so many milliseconds of work, but at most two submissions at once. It
    /// never waits.
    ///
    /// # Errors
    /// The device failed.
    pub fn advance(&mut self, budget_ms: f64) -> Result<(), RenderError> {
        self.receive()?;
        let aim = budget_ms.clamp(1.0, LONGEST_MS);
        let factor = aim / self.kept.aim_ms;
        if !(0.5..=2.0).contains(&factor) {
            self.kept.aim_ms = aim;
            for cost in &mut self.kept.costs {
                cost.scale(factor);
            }
        }
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
        if self.collected < self.job.made.blocks.len() {
            return Ok(None);
        }
        self.kept.made = Some(self.job.made.clone());
        let mut frame = std::mem::take(&mut self.frame);
        frame.finish(std::mem::take(&mut self.job.prepared));
        Ok(Some(frame))
    }

    /// Waits for the frame. `watch` is told of each pass that has ended, and of the progress in
    /// a long pass.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`] if `watch` returns `false`. The device failed, or left cells
    /// unvisited.
    pub fn finish(mut self, watch: Watch<'_>) -> Result<Frame, RenderError> {
        let mut told = 0;
        loop {
            self.advance(f64::INFINITY)?;
            let frame = self.poll()?;
            let is_pass = |stage: &u32| {
                let (_, index) = self.place(*stage);
                matches!(self.job.kinds[index], StageKind::Pass(_))
            };
            let ended = (told..self.reached).filter(is_pass);
            let mut news: Vec<Progress> = ended
                .map(|stage| Progress {
                    done: self.progress_at(stage + 1, 0.0).done,
                    ..self.progress_at(stage, 0.0)
                })
                .collect();
            if news.is_empty() && self.reached < self.end() {
                news.push(self.progress());
            }
            told = self.reached;
            for progress in news {
                if !watch(&progress) {
                    return Err(RenderError::Cancelled);
                }
                self.shared.device.check()?;
            }
            if let Some(frame) = frame {
                return Ok(frame);
            }
            if let Some(flight) = self.flights.front() {
                let index = Some(flight.index.clone());
                self.shared.device.wait_for(index)?;
            }
        }
    }
}

impl Work {
    fn shelf(&self) -> MutexGuard<'_, Kept> {
        let kept = self.shared.kept.lock();
        kept.unwrap_or_else(PoisonError::into_inner)
    }

    /// Leaves everything to the next render. The device may still run what was submitted; the
    /// next render is behind it.
    pub(super) fn lend(&mut self) {
        let kept = std::mem::take(&mut self.kept);
        *self.shelf() = kept;
    }

    /// Takes back what no other render took.
    pub(super) fn take_back(&mut self) {
        let kept = std::mem::take(&mut *self.shelf());
        self.kept = kept;
    }

    pub(super) fn extras(&self) -> Extras {
        self.job.extras
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        // Another render may have taken it already.
        if self.kept.target.is_some() {
            self.lend();
        }
    }
}
