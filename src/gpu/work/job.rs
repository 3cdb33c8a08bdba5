//! What a run is made of, and what one run leaves to the next.

use wgpu::DeviceType;

use crate::base::filter::{lens_share, offset};
use crate::base::shader::Program;
use crate::gpu::cost::{Cost, faster};
use crate::gpu::staging::Stagings;
use crate::gpu::stamps::Stamps;
use crate::gpu::target::{Needs, Parameters, Target};
use crate::heightfield::assets::Preparation;
use crate::pass::layout::Layout;
use crate::pass::turn::{FIRST_PICTURE, Stage, StageKind};
use crate::pass::until::{bound, is_judged};
use crate::plan::pyramid::{Block, Level};
use crate::plan::{Extras, Pass};

/// What a frame is made of, as far as that may stay when the look changes. The scene's arrays,
/// the programs and the sizes of a target stay anyway.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::gpu) struct Made {
    /// Whether rays start without cones: then there are at most the cones of the first picture.
    pub rays_alone: bool,
    pub passes: Vec<Pass>,
    pub blocks: Vec<Layout>,
    pub ray_steps: u32,
    /// Parameters of cones and rays.
    pub marched: Parameters,
    /// Parameters of the colours.
    pub look: Vec<u8>,
    /// Programs from the colours on.
    pub colors: Vec<Program>,
}

impl Made {
    /// The stage from which a frame of so many visits goes on after a finished one, if it can.
    pub(super) fn resumes(&self, last: &Self, kinds: &[StageKind], visits: u32) -> Option<u32> {
        let same_rays = Self {
            look: last.look.clone(),
            colors: last.colors.clone(),
            ..self.clone()
        } == *last;
        // The buffers hold one block, and of its rays those of the last visit.
        if !same_rays || self.blocks.len() > visits as usize {
            return None;
        }
        let color = kinds
            .iter()
            .position(|k| *k == StageKind::Pass(Pass::Color))? as u32;
        match self.look == last.look && self.colors == last.colors {
            // The tone decides which tiles end.
            true if kinds.contains(&StageKind::Judge) => None,
            true => Some((visits - 1) * kinds.len() as u32 + color + 1),
            false => (visits == 1).then_some(color),
        }
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
    pub stagings: Stagings,
    /// What the last frame was made of, if it was finished.
    pub made: Option<Made>,
}

/// What a render knows from the start.
///
/// If an image of several blocks is sketched, the coarse levels run over all blocks
/// before any ray, and once more with each block. Each sample of the pixels is a further visit of
/// a block, whose cones stay. The last one is that of the pixels' centres, whose depths stay.
pub(in crate::gpu) struct Job {
    pub kinds: Vec<StageKind>,
    /// The first stage that only colours need.
    pub colors_at: usize,
    pub made: Made,
    /// How many of the blocks come before all others, only for a first picture of the whole image,
    /// and how many stages of them run.
    pub firsts: usize,
    pub first_stages: usize,
    /// Whether colours follow light by rays.
    pub follows_light: bool,
    /// The most iterations of an evaluation.
    pub iterations: u32,
    /// Samples of each pixel, and how often a block is visited for them.
    pub samples: u32,
    pub visits: u32,
    /// The error at which tiles end; 0 if they do not.
    pub until: f64,
    /// The step limits of the first dispatch of a stage and of the largest.
    pub steps: [u32; 2],
    pub extras: Extras,
    pub map_times: Vec<(Preparation, f64)>,
}

impl Job {
    /// The costs of the stages, where those of the last frame say nothing of them.
    pub(super) fn first_costs(&self, device: DeviceType) -> Vec<Cost> {
        let faster = faster(device, self.iterations);
        let follows =
            |kind: &StageKind| self.follows_light && *kind == StageKind::Pass(Pass::Color);
        self.kinds
            .iter()
            .map(|kind| Cost::first(follows(kind), faster))
            .collect()
    }

    /// The blocks of the image. They are visited one after the other, each as often as a pixel has
    /// samples.
    pub(super) fn blocks(&self) -> impl ExactSizeIterator<Item = Block> {
        let visits = self.made.blocks[self.firsts..].chunks(self.visits as usize);
        visits.map(|of| of[0].block)
    }

    /// The number of the block of a visit, and how many samples it has before; `None` for a first
    /// picture.
    pub(super) fn sampled(&self, visit: usize) -> Option<(usize, u32)> {
        let visit = visit.checked_sub(self.firsts)?;
        let visits = self.visits as usize;
        Some((visit / visits, (visit % visits) as u32))
    }

    /// The number of a block, if a visit makes its last sample.
    pub(super) fn completes(&self, visit: usize) -> Option<usize> {
        let last = self.visits - 1;
        self.sampled(visit)
            .filter(|(_, before)| *before == last)
            .map(|(block, _)| block)
    }

    /// Whether a stage of a visit is left out.
    pub(super) fn leaves_out(&self, visit: usize, index: usize) -> bool {
        let kind = &self.kinds[index];
        let shows = |level: &Level| {
            level.divisor >= FIRST_PICTURE && self.kinds.contains(&StageKind::Sketch(*level))
        };
        if let StageKind::Pass(Pass::March(level)) | StageKind::Sketch(level) = kind
            && self.made.rays_alone
            && (!shows(level) || (self.firsts > 0 && self.sampled(visit).is_some()))
        {
            return true;
        }
        let Some((_, before)) = self.sampled(visit) else {
            return index >= self.first_stages;
        };
        match kind {
            // The first picture is finer.
            StageKind::Sketch(_) => before > 0 || (self.firsts > 0 && index < self.first_stages),
            StageKind::Pass(Pass::March(_)) => before > 0,
            StageKind::Census => self.completes(visit).is_none(),
            StageKind::Judge => !is_judged(before + 1, self.samples),
            _ => false,
        }
    }

    /// Sets what the stages of a visit do for its sample.
    pub(super) fn sample(&self, visit: usize, index: usize, stage: &mut Stage) {
        if self.made.rays_alone {
            match self.kinds[index] {
                StageKind::Pass(Pass::Trace) => stage.parent_width = 0,
                StageKind::Census => stage.divisor = 1,
                _ => {}
            }
        }
        let Some((_, before)) = self.sampled(visit) else {
            return;
        };
        let of_all = 1.0 / self.samples as f32;
        let sample = self.visits - 1 - before;
        let is_last = sample == 0;
        stage.before = before;
        // The place takes some time to find.
        if matches!(
            self.kinds[index],
            StageKind::Pass(Pass::Trace | Pass::Color)
        ) {
            stage.place = (0.5 + offset(sample)).as_vec2().to_array();
            if !is_last {
                stage.lens = lens_share(sample).as_vec2().to_array();
            }
        }
        if self.kinds[index] == StageKind::Judge {
            stage.until = bound(self.until, before + 1) as f32;
        }
        // Behind a lens, the centre counts for the depth alone.
        stage.weight = f32::from(u8::from(before < self.samples));
        stage.scale = match (&self.kinds[index], is_last) {
            (StageKind::Pass(_), true) => of_all,
            (StageKind::Develop, false) => 1.0 / (before + 1) as f32,
            _ => 1.0,
        };
    }
}

impl Reusable {
    /// Programs and sizes of the last frame.
    pub fn needs(&self) -> Option<Needs> {
        self.target.as_ref().map(|target| target.needs.clone())
    }
}
