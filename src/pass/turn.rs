//! The stages of a frame on a GPU, and the dispatch that is under way.
//!
//! A stage is a pass over a block, or a short one of [`StageKind`] between them. The CPU executor
//! has no stages, as it runs every cell to its end at once. Twin: `wgsl/pass/turn.wgsl`.

use bytemuck::{Pod, Zeroable};

use crate::base::shader::{Module, Program};
use crate::pass::{features::sky, program};
use crate::plan::pyramid::Level;
use crate::plan::{Extras, Pass, Plan};
use crate::scene::AnySolid;
use crate::wgsl;

/// The numbers of a stage, which the host writes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Stage {
    /// Position among all stages of the frame.
    pub number: u32,
    /// The step limit of a cell.
    pub limit: u32,
    /// The step limit of the first dispatch. Each later round has four times as many.
    pub chunk: u32,
    /// The largest step limit of a dispatch.
    pub most: u32,
    /// The largest product of workgroups and step limit of a dispatch.
    pub slice: u32,
    /// Workgroups that visit every cell; 0 if the stage is left out.
    pub tiles: u32,
    /// Cells per row of the parent level in the block; 0 if there is no parent level.
    pub parent_width: u32,
    /// Pixels per cell, along each axis.
    pub divisor: u32,
    /// First cell of the block.
    pub origin: [u32; 2],
    /// Cells in the block.
    pub cells: [u32; 2],
    /// Factor on the cone's chord.
    pub fudge: f32,
    /// Position among the stages of the block.
    pub index: u32,
    /// Where its two queues start in the lists.
    pub queues: [u32; 2],
    /// Where its parents are listed.
    pub listed: u32,
    /// Where it lists parents itself.
    pub parents: u32,
    /// Where the parents' fronts start in the values of all cells.
    pub parent_front: u32,
    /// Where the fronts start.
    pub front: u32,
    /// Where the states start.
    pub state: u32,
    /// Where the counts of work start, two to a cell.
    pub tally: u32,
    /// Where the marks of hits start, three words to a pixel.
    pub mark: u32,
    /// Where the light of the pixels starts, and then kept normals, four words to a pixel.
    pub light: u32,
    /// The number of the block, which is part of every state.
    pub generation: u32,
    /// Samples of the pixels whose light is summed already.
    pub before: u32,
    /// Where the rays of this sample go, in pixels from the upper left corner of their pixels.
    pub place: [f32; 2],
    /// Where on the lens they start, from 0 to 1 along both axes; below 0 for its centre.
    pub lens: [f32; 2],
    /// A factor on the light of the sample.
    pub weight: f32,
    /// A factor on the sum of the light.
    pub scale: f32,
    /// Where the halves start that `wgsl/pass/judge.wgsl` keeps, four words to a pixel.
    pub halves: u32,
    /// A tile ends if its squared error is below this, in levels of the tone; below 0 if it may not
    /// end yet.
    pub until: f32,
}

/// What the next dispatch does. Only the device writes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Turn {
    /// The stage that has begun last.
    pub stage: Stage,
    /// The number of the stage that is under way.
    pub number: u32,
    /// 1 if the stage has begun.
    pub begun: u32,
    /// The step limit of the dispatch.
    pub chunk: u32,
    /// Steps done in the rounds before.
    pub done: u32,
    /// The first workgroup of the dispatch in its round.
    pub first: u32,
    /// Workgroups of the dispatch.
    pub groups: u32,
    /// What is visited: all cells, the children of listed parents, or listed cells.
    pub visits: u32,
    /// Number of listed cells or parents.
    pub count: u32,
    /// Where the list starts.
    pub read: u32,
    /// Where the queue starts that is filled.
    pub filled: u32,
    /// Dispatches of the stage.
    pub dispatches: u32,
    /// Unused.
    pub pad: u32,
}

impl Turn {
    /// Workgroups of the round.
    fn groups_of_round(&self) -> u32 {
        match self.visits {
            0 => self.stage.tiles,
            1 => self.count.div_ceil(16),
            _ => self.count.div_ceil(64),
        }
    }

    /// The stage that goes on next, if so many cells move: `close_ended` in
    /// `wgsl/pass/arrange.wgsl` comes to the same before the next dispatch.
    pub fn next(&self, moving: u32) -> u32 {
        let is_over = self.first + self.groups >= self.groups_of_round();
        self.number + u32::from(self.begun == 1 && is_over && moving == 0)
    }

    /// Dispatches that finish this round and the next one, if so many cells move so far.
    pub fn dispatches_left(&self, moving: u32) -> u32 {
        let groups = |chunk: u32| (self.stage.slice / chunk.max(1)).max(1);
        let left = self
            .groups_of_round()
            .saturating_sub(self.first + self.groups);
        let next = (4 * self.chunk).min(self.stage.most);
        left.div_ceil(groups(self.chunk)) + moving.div_ceil(64).div_ceil(groups(next))
    }

    /// The share of the stage that is done, about: most cells end in the first round.
    pub fn share(&self) -> f64 {
        if self.begun == 0 {
            return 0.0;
        }
        let done = self.first + self.groups;
        let round = f64::from(done) / f64::from(self.groups_of_round().max(1));
        match self.done {
            0 => 0.8 * round.min(1.0),
            _ => 0.8 + 0.2 * round.min(1.0),
        }
    }
}

/// The divisor of the finest level of the first picture.
pub const FIRST_PICTURE: u32 = 4;
/// The most stages of a block.
pub const MOST_STAGES: usize = 20;

/// What a stage does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StageKind {
    /// A pass over the block.
    Pass(Pass),
    /// Shows the fronts of a cone level in the picture.
    Sketch(Level),
    /// Ends the samples of tiles whose error is small.
    Judge,
    /// Shows the colours in the picture.
    Develop,
    /// Counts the cells that were left out.
    Census,
}

impl StageKind {
    /// The stages of a block, in order; some only if the picture is shown, if it is sketched
    /// before, or if tiles are judged.
    pub fn all(passes: &[Pass], [shown, sketched, judged]: [bool; 3]) -> Vec<Self> {
        let of_pass = |pass: &Pass| {
            let after = match pass {
                Pass::March(level) if sketched => Some(Self::Sketch(*level)),
                Pass::Color if shown => Some(Self::Develop),
                _ => None,
            };
            let judge = (judged && *pass == Pass::Color).then_some(Self::Judge);
            [Some(Self::Pass(*pass)), judge, after]
        };
        let passes = passes.iter().flat_map(of_pass).flatten();
        passes.chain([Self::Census]).collect()
    }

    /// Stages that are enough for a first picture of a block: up to the sketch of its finest level,
    /// which takes a few percent of the time; 0 without such a sketch.
    pub fn first_picture(kinds: &[Self]) -> usize {
        let is_coarse =
            |kind: &Self| matches!(kind, Self::Sketch(level) if level.divisor >= FIRST_PICTURE);
        kinds.iter().rposition(is_coarse).map_or(0, |last| last + 1)
    }

    /// The program of the stage.
    pub fn program(self, plan: &Plan, solid: &AnySolid, extras: Extras) -> Program {
        let over_cells = |entry, own: &[Module]| {
            let mut all = vec![wgsl!("base/outcome.wgsl"), wgsl!("pass/shared.wgsl")];
            all.extend(modules());
            all.extend_from_slice(own);
            Program::new(entry, all)
        };
        match self {
            Self::Pass(pass) => program(plan, solid, pass, extras),
            Self::Census => over_cells("census", &[wgsl!("pass/census.wgsl")]),
            Self::Judge => {
                let own = [background(plan, extras), wgsl!("pass/judge.wgsl")];
                let own = [tone(), own.into()];
                over_cells("judge", &own.concat())
            }
            Self::Develop => {
                let own = [tone(), vec![until(plan), wgsl!("pass/develop.wgsl")]];
                over_cells("develop", &own.concat())
            }
            Self::Sketch(_) => {
                let mut all = plan.view().modules();
                all.extend([wgsl!("pass/look.wgsl"), sky(&plan.look)]);
                all.extend(tone());
                all.push(wgsl!("pass/sketch.wgsl"));
                over_cells("sketch", &all)
            }
        }
    }
}

/// The module that tells which pixels have ended.
pub(super) fn until(plan: &Plan) -> Module {
    match plan.is_adaptive() {
        true => wgsl!("pass/until.wgsl"),
        false => wgsl!("pass/until_off.wgsl"),
    }
}

/// The module that tells what is behind the hits.
pub(super) fn background(plan: &Plan, extras: Extras) -> Module {
    match plan.is_transparent(extras) {
        true => wgsl!("pass/background.wgsl"),
        false => wgsl!("pass/background_off.wgsl"),
    }
}

/// The modules that show light.
fn tone() -> Vec<Module> {
    vec![wgsl!("pass/tone.wgsl"), wgsl!("pass/tone_map.wgsl")]
}

/// The modules of a program over cells.
pub fn modules() -> [Module; 2] {
    [wgsl!("pass/turn.wgsl"), wgsl!("pass/queue.wgsl")]
}

/// The program that decides what the next dispatch visits.
pub fn arrange() -> Program {
    let modules = vec![wgsl!("pass/turn.wgsl"), wgsl!("pass/arrange.wgsl")];
    Program::new("arrange", modules)
}
