//! The submissions of a frame: what is encoded next, and what came back.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Arc, PoisonError};

use crate::gpu::cost::{Cost, LONGEST_MS};
use crate::gpu::error::RenderError;
use crate::gpu::staging::Staging;
use crate::gpu::stamps::{STAMPS, Stamps};
use crate::gpu::target::{Needs, Parameters, Target};
use crate::gpu::work::{FrameInputs, Shared};
use crate::heightfield::assets::Preparation;
use crate::pass::progress::Progress;
use crate::pass::turn::{CellsHead, Layout, MOST_STAGES, Stage, StageKind, Turn};
use crate::picture::frame::{Frame, Traffic};
use crate::plan::{Extras, Pass};

/// The longest estimated submission in milliseconds. A window that shares the device stays
/// fluid, and the device is free soon after a render was cancelled.
pub const SUBMISSION_MS: f64 = 40.0;
/// Submissions that the device may have at once: one runs, and one is next.
const IN_FLIGHT: usize = 2;
/// Bytes of a report: the turn, the head of the lists, and timestamps.
pub(super) const REPORT: u64 = (size_of::<Turn>() + size_of::<CellsHead>()) as u64 + STAMPS;

/// What a frame is made of, as far as that may stay when the look changes. The scene's arrays,
/// the programs and the sizes of a target stay anyway.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::gpu) struct Made {
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
pub(in crate::gpu) struct Reusable {
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
///
/// If an image of several blocks is shown while it is made, the coarse levels run over all blocks
/// before any ray, and once more with each block.
pub(in crate::gpu) struct Job {
    pub kinds: Vec<StageKind>,
    pub made: Made,
    /// How many of the blocks come before all others, only for a first picture of the whole image,
    /// and how many stages of them run.
    pub firsts: usize,
    pub first_stages: usize,
    /// The step limits of the first dispatch of a stage and of the largest.
    pub steps: [u32; 2],
    pub extras: Extras,
    pub map_times: Vec<(Preparation, f64)>,
}

impl Job {
    /// Whether a stage of a block is left out.
    fn leaves_out(&self, block: usize, index: usize) -> bool {
        let is_sketch = || matches!(self.kinds[index], StageKind::Sketch(_));
        match block < self.firsts {
            true => index >= self.first_stages,
            // The first picture is finer.
            false => self.firsts > 0 && index < self.first_stages && is_sketch(),
        }
    }
}

/// A submission that has not ended, as far as the host knows.
pub(super) struct Flight {
    #[cfg(feature = "cli")]
    pub index: wgpu::SubmissionIndex,
    pub report: Staging,
    /// Results of a block, if its last stage is in the submission.
    pub reading: Option<(usize, Staging)>,
    /// The first stage in it, and the stage that should be under way after it.
    pub stages: Range<u32>,
    /// How many stages have dispatches in it.
    pub encoded: u32,
    /// Corrections that the host had made before.
    pub corrections: u32,
    pub submitted: f64,
}

/// The run of a frame on a device.
pub struct Run {
    pub(super) shared: Arc<Shared>,
    pub(super) reusable: Reusable,
    pub(super) job: Job,
    pub(super) frame: Frame,
    /// The first stage; later than 0 if the frame goes on from the one before.
    pub(super) from: u32,
    /// The stage to encode next, and how many dispatches of it are to be encoded.
    pub(super) cursor: u32,
    pub(super) dispatches: u32,
    /// The stage under way on the device, as of the last report, and the share of it that is
    /// done, about.
    pub(super) reached: u32,
    pub(super) share: f64,
    /// Dispatches of each stage of the block under way, as of the last report.
    pub(super) told: [u32; MOST_STAGES],
    pub(super) flights: VecDeque<Flight>,
    pub(super) corrections: u32,
    pub(super) ended: f64,
    /// Blocks in the frame, without those of the first picture.
    pub(super) collected: usize,
}

impl Reusable {
    /// Programs and sizes of the last frame.
    pub fn needs(&self) -> Option<Needs> {
        self.target.as_ref().map(|target| target.needs.clone())
    }
}

impl Run {
    /// Begins a frame with what the last one left, as far as it serves.
    ///
    /// # Errors
    /// The device has no room.
    pub fn begin(shared: Arc<Shared>, inputs: FrameInputs) -> Result<Self, RenderError> {
        let FrameInputs {
            job,
            mut frame,
            needs,
            parameters,
            kernels,
            arrange,
            arrays,
        } = inputs;
        let device = &shared.device;
        let shelf = shared.reusable.lock();
        let mut shelf = shelf.unwrap_or_else(PoisonError::into_inner);
        let traffic = frame.traffic.get_or_insert_default();
        match &mut shelf.target {
            Some(target) if target.serves(&needs, &parameters, &arrays) => {
                traffic.uploads += target.rewrite(device, parameters);
            }
            _ => {
                traffic.uploads += parameters.iter().map(|(_, b)| b.len()).sum::<usize>();
                traffic.allocations = 1;
                let target = Target::new(device, kernels, arrange, needs, parameters, &arrays)?;
                *shelf = Reusable {
                    target: Some(target),
                    costs: vec![Cost::default(); job.kinds.len()],
                    aim_ms: LONGEST_MS,
                    stamps: Stamps::new(device),
                    ..Reusable::default()
                };
            }
        }
        let kept = std::mem::take(&mut *shelf);
        drop(shelf);
        Ok(Self::new(shared, kept, job, frame))
    }

    fn new(shared: Arc<Shared>, kept: Reusable, job: Job, frame: Frame) -> Self {
        let ended = (shared.device.clock)();
        let mut run = Self {
            shared,
            reusable: kept,
            job,
            frame,
            from: 0,
            cursor: 0,
            dispatches: 0,
            reached: 0,
            share: 0.0,
            told: [0; MOST_STAGES],
            flights: VecDeque::new(),
            corrections: 0,
            ended,
            collected: 0,
        };
        let last = run.reusable.made.take().filter(|_| run.job.extras.reuse);
        let first = last.and_then(|last| run.job.made.resumes(&last, &run.job.kinds));
        run.from = first.unwrap_or(0);
        run.reached = run.from;
        let blocks = run.job.made.blocks.len();
        let device = &run.shared.device;
        match (&mut run.reusable.target, first) {
            (Some(target), Some(first)) => target.resume(device, first),
            (Some(target), None) => target.begin(device, blocks),
            (None, _) => {}
        }
        run.go_to(run.reached);
        run
    }

    /// Stages of a block.
    pub(super) fn per_block(&self) -> u32 {
        self.job.kinds.len() as u32
    }

    pub(super) fn end(&self) -> u32 {
        self.per_block() * self.job.made.blocks.len() as u32
    }

    /// The block of a stage, and the stage's position in it.
    pub(super) fn place(&self, stage: u32) -> (usize, usize) {
        let n = self.per_block();
        ((stage / n) as usize, (stage % n) as usize)
    }

    /// The pass that a stage of a block is or follows; before the first one, the first.
    pub(super) fn pass_at(&self, index: usize) -> usize {
        let stages = &self.job.kinds[..=index];
        let passes = stages.iter().filter(|k| matches!(k, StageKind::Pass(_)));
        passes.count().max(1) - 1
    }

    /// The number of a block, which tells its states from older ones.
    pub(super) fn generation(&self, block: usize) -> u32 {
        let later = self.job.made.blocks.len() - 1 - block;
        let target = self.reusable.target.as_ref();
        target.map_or(0, |target| target.generation(later))
    }

    /// The stages of a block, with what is known of their costs.
    pub(super) fn stages(&self, block: usize) -> Vec<Stage> {
        let first = block as u32 * self.per_block();
        let layout = &self.job.made.blocks[block];
        let mut stages = layout.stages(&self.job.kinds, first, self.job.made.ray_steps);
        for (index, (stage, cost)) in stages.iter_mut().zip(&self.reusable.costs).enumerate() {
            [stage.chunk, stage.most] = self.job.steps;
            stage.slice = cost.slice;
            stage.generation = self.generation(block);
            if self.job.leaves_out(block, index) {
                stage.tiles = 0;
            }
        }
        stages
    }

    /// Encodes from a stage on.
    pub(super) fn go_to(&mut self, stage: u32) {
        self.cursor = stage;
        if stage < self.end() {
            let (block, index) = self.place(stage);
            let stage = self.stages(block)[index];
            self.dispatches = self.reusable.costs[index].dispatches(&stage);
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
        self.reusable.target.as_ref()?.picture.as_ref()
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
        let factor = aim / self.reusable.aim_ms;
        if !(0.5..=2.0).contains(&factor) {
            self.reusable.aim_ms = aim;
            for cost in &mut self.reusable.costs {
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
        if self.collected < self.job.made.blocks.len() - self.job.firsts {
            return Ok(None);
        }
        self.reusable.made = Some(self.job.made.clone());
        let mut frame = std::mem::take(&mut self.frame);
        frame.finish(std::mem::take(&mut self.job.map_times));
        Ok(Some(frame))
    }

    /// What there is to tell of the stages that have ended from `told` on, or of the one under way.
    #[cfg(feature = "cli")]
    pub fn news(&self, told: u32) -> Vec<Progress> {
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
        news
    }

    /// Waits for the oldest submission.
    ///
    /// # Errors
    /// The device failed.
    #[cfg(feature = "cli")]
    pub fn wait(&self) -> Result<(), RenderError> {
        if let Some(flight) = self.flights.front() {
            let index = Some(flight.index.clone());
            self.shared.device.wait_for(index)?;
        }
        Ok(())
    }
}

impl Run {
    /// Leaves everything to the next render. The device may still run what was submitted; the
    /// next render is behind it.
    pub(super) fn lend(&mut self) {
        let shelf = self.shared.reusable.lock();
        *shelf.unwrap_or_else(PoisonError::into_inner) = std::mem::take(&mut self.reusable);
    }

    /// Takes back what no other render took.
    pub(super) fn take_back(&mut self) {
        let shelf = self.shared.reusable.lock();
        self.reusable = std::mem::take(&mut *shelf.unwrap_or_else(PoisonError::into_inner));
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        // Another render may have taken it already.
        if self.reusable.target.is_some() {
            self.lend();
        }
    }
}
