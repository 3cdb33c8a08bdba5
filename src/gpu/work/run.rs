//! The submissions of a frame: what is encoded next, and what came back.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;
#[cfg(feature = "cli")]
use std::time::Duration;

use crate::gpu::cost::LONGEST_MS;
use crate::gpu::error::RenderError;
use crate::gpu::staging::Staging;
use crate::gpu::stamps::{STAMPS, Stamps};
use crate::gpu::target::Target;
#[cfg(feature = "cli")]
use crate::gpu::wait::Patience;
use crate::gpu::work::job::{Job, Reusable};
use crate::gpu::work::{FrameInputs, Shared};
use crate::pass::layout::CellsHead;
use crate::pass::progress::Progress;
use crate::pass::turn::{MOST_STAGES, Stage, StageKind, Turn};
use crate::picture::frame::{Frame, Traffic};
use crate::plan::Pass;

/// The longest estimated submission in milliseconds. A window that shares the device stays
/// fluid, and the device is free soon after a render was cancelled.
pub const SUBMISSION_MS: f64 = 40.0;
/// Submissions that the device may have at once: one runs, and one is next.
const IN_FLIGHT: usize = 2;
/// Bytes of a report: the turn, the head of the lists, and timestamps.
pub(super) const REPORT: u64 = (size_of::<Turn>() + size_of::<CellsHead>()) as u64 + STAMPS;

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
    #[cfg(feature = "cli")]
    patience: Patience,
    /// Blocks in the frame, without those of the first picture.
    pub(super) collected: usize,
    delivered: bool,
    /// Whether the device was asked since the last submission.
    received: bool,
}

impl Run {
    /// Begins a frame with what the last one left, as far as it serves.
    ///
    /// # Errors
    /// The device has no room.
    pub fn begin(
        shared: Arc<Shared>,
        inputs: FrameInputs,
        reusable: &mut Reusable,
    ) -> Result<Self, RenderError> {
        let FrameInputs {
            job,
            mut frame,
            needs,
            parameters,
            kernels,
            arrange,
            arrays,
            texts: _,
            edited: _,
        } = inputs;
        let device = &shared.device;
        let traffic = frame.traffic.get_or_insert_default();
        match &mut reusable.target {
            Some(target)
                if target.serves(&needs, &arrange, job.colors_at, &parameters, &arrays) =>
            {
                // Another program takes another time.
                let first = job.first_costs(device.info.device_type);
                for (stage, (cost, first)) in reusable.costs.iter_mut().zip(first).enumerate() {
                    if target.needs.programs[stage] != needs.programs[stage] {
                        *cost = first;
                    }
                }
                target.rebind(device, kernels, needs, &arrays)?;
                traffic.uploads += target.rewrite(device, parameters);
            }
            _ => {
                traffic.uploads += parameters.iter().map(|(_, b)| b.len()).sum::<usize>();
                traffic.allocations = 1;
                let target = Target::new(device, kernels, arrange, needs, parameters, &arrays)?;
                *reusable = Reusable {
                    target: Some(target),
                    costs: job.first_costs(device.info.device_type),
                    aim_ms: LONGEST_MS,
                    stamps: Stamps::new(device),
                    stagings: std::mem::take(&mut reusable.stagings).into_behind(),
                    ..Reusable::default()
                };
            }
        }
        let reusable = std::mem::take(reusable);
        Ok(Self::new(shared, reusable, job, frame))
    }

    fn new(shared: Arc<Shared>, reusable: Reusable, job: Job, frame: Frame) -> Self {
        let ended = (shared.device.clock)();
        let mut run = Self {
            shared,
            reusable,
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
            #[cfg(feature = "cli")]
            patience: Patience::default(),
            collected: 0,
            delivered: false,
            received: false,
        };
        let last = run.reusable.made.take().filter(|_| run.job.extras.reuse);
        let (job, visits) = (&run.job, run.job.visits);
        let first = last.and_then(|last| job.made.resumes(&last, &job.kinds, visits));
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

    /// The number of the block of a visit, which tells its states from older ones.
    pub(super) fn generation(&self, visit: usize) -> u32 {
        let number = match self.job.sampled(visit) {
            Some((block, _)) => self.job.firsts + block,
            None => visit,
        };
        let later = self.job.firsts + self.job.blocks().len() - 1 - number;
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
            // A second round of a small stage would take longer than all its steps.
            if stage.tiles.saturating_mul(stage.limit) <= stage.slice {
                stage.chunk = stage.chunk.max(stage.limit);
            }
            stage.generation = self.generation(block);
            self.job.sample(block, index, stage);
            // A frame that goes on from the one before keeps its cells, which were counted then.
            let counted = self.from > 0 && self.job.kinds[index] == StageKind::Census;
            if counted || self.job.leaves_out(block, index) {
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

    /// The size of dispatches of the stage that is encoded next.
    pub(super) fn slice(&self) -> Option<u32> {
        let within = self.cursor < self.end();
        within.then(|| self.reusable.costs[self.place(self.cursor).1].slice)
    }

    /// Encodes as many dispatches as the rest of the stage needs, once their size has changed.
    pub(super) fn follow_slice(&mut self, before: Option<u32>) {
        if let (Some(before), Some(now)) = (before, self.slice()) {
            let all = u64::from(self.dispatches) * u64::from(before);
            self.dispatches = all.div_ceil(u64::from(now)) as u32;
        }
    }

    /// How far the render has come.
    pub fn progress(&self) -> Progress {
        self.progress_at(self.reached, self.share)
    }

    /// The progress when a stage is under way of which a share is done.
    fn progress_at(&self, stage: u32, share: f64) -> Progress {
        let is_pass = |k: &&StageKind| matches!(k, StageKind::Pass(_));
        if stage >= self.end() {
            let last = self.job.made.passes.last();
            return Progress {
                pass: last.map(Pass::name).unwrap_or_default(),
                done: 1.0,
                is_step: false,
            };
        }
        let (block, index) = self.place(stage);
        let firsts = self.job.firsts;
        let before = self.job.kinds[..index].iter().filter(is_pass).count();
        let passes = self.job.made.passes.len();
        let share = match self.job.kinds[index] {
            StageKind::Pass(_) => share,
            _ => 0.0,
        };
        // The first picture takes little.
        let done = match block.checked_sub(firsts) {
            Some(block) => (block * passes + before) as f64 + share,
            None => 0.0,
        };
        let all = passes * (self.job.made.blocks.len() - firsts);
        Progress {
            pass: self.job.made.passes[self.pass_at(index)].name(),
            done: (done / all as f64).min(1.0),
            is_step: false,
        }
    }

    /// The picture as far as it is made: first the fronts of the coarse levels, then colours.
    /// `None` without [`Extras::shown`], or if the image has a window or is larger than a texture can
    /// be. Its bytes are those of sRGB, as files hold them.
    pub fn picture(&self) -> Option<&wgpu::Texture> {
        self.reusable.target.as_ref()?.shared.picture.as_ref()
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
        let submitted = self.cursor;
        // What is no number is no budget.
        let budget_ms = budget_ms.max(0.0);
        let aim = budget_ms.clamp(1.0, LONGEST_MS);
        let factor = aim / self.reusable.aim_ms;
        if !(1.0..=2.0).contains(&factor) {
            self.reusable.aim_ms = aim;
            let slice = self.slice();
            for cost in &mut self.reusable.costs {
                cost.scale(factor);
            }
            self.follow_slice(slice);
        }
        self.fill(budget_ms);
        self.received = self.cursor == submitted;
        Ok(())
    }

    /// Whether there is something to submit, and the device has less than it may have at once. What was
    /// submitted of another plan comes first.
    fn has_room(&mut self) -> bool {
        let submitted = self.flights.len() + self.reusable.stagings.behind();
        submitted < IN_FLIGHT && self.cursor < self.end()
    }

    /// Submits about so many milliseconds of work, if there is room.
    pub(super) fn fill(&mut self, budget_ms: f64) {
        let mut left = budget_ms;
        while left > 0.0 && self.has_room() {
            left -= self.submit(left.min(SUBMISSION_MS));
        }
    }

    /// The frame, once it is finished. It never waits.
    ///
    /// # Errors
    /// The device failed, or left cells unvisited.
    pub fn poll(&mut self) -> Result<Option<Frame>, RenderError> {
        // A question to the device takes some of the time that a picture has on the host.
        if !std::mem::take(&mut self.received) {
            self.receive()?;
        }
        if self.collected < self.job.blocks().len() {
            return Ok(None);
        }
        if std::mem::replace(&mut self.delivered, true) {
            return Ok(None);
        }
        self.reusable.made = Some(self.job.made.clone());
        let traffic = self.frame.traffic;
        let mut frame = std::mem::take(&mut self.frame);
        self.frame.traffic = traffic;
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

    /// Whether the frame was handed over.
    #[cfg(feature = "cli")]
    pub fn is_delivered(&self) -> bool {
        self.delivered
    }

    /// Waits a moment for the oldest submission, unless there is something to submit.
    ///
    /// # Errors
    /// The device failed, or has not answered for two minutes: a dispatch has a bounded number of
    /// steps.
    #[cfg(feature = "cli")]
    pub fn wait(&mut self) -> Result<(), RenderError> {
        if self.has_room() {
            return Ok(());
        }
        let device = &self.shared.device;
        let begun = (device.clock)();
        let since = match self.flights.front() {
            Some(flight) => {
                device.wait_a_moment(flight.index.clone())?;
                flight.submitted.max(self.ended)
            }
            None => {
                // The device runs what was submitted of another plan.
                std::thread::sleep(Duration::from_millis(1));
                self.ended
            }
        };
        if self.patience.ends(since, (device.clock)() - begun) {
            return Err(device.lost("it has not answered for two minutes").into());
        }
        Ok(())
    }
}
