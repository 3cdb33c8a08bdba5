//! The stages of a frame on a GPU, and the dispatch that is under way.
//!
//! A stage is a pass over a block, or one of two short stages about it: the first marks all
//! cells as not visited, the last counts the cells that were left out. The CPU executor has no
//! stages, as it runs every cell to its end at once. Twin: `wgsl/pass/turn.wgsl`.

use bytemuck::{Pod, Zeroable};

use crate::base::shader::{Module, Program};
use crate::plan::Pass;
use crate::plan::pyramid::Block;
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
    /// The largest product of the workgroups and the step limit of a dispatch.
    pub slice: u32,
    /// Workgroups that visit every cell.
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
    /// Unused.
    pub pad: u32,
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

/// The most stages of a block.
pub const MOST_STAGES: usize = 12;

/// The head of the lists. The cells follow it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ListsHead {
    /// Cells that still move.
    pub moving: u32,
    /// Cells whose children the next stage visits.
    pub parents: u32,
    /// Cells that should have been visited and were not, or the reverse.
    pub wrong: u32,
    /// Unused.
    pub pad: u32,
    /// Dispatches of each stage of the block.
    pub dispatches: [u32; MOST_STAGES],
}

/// Words that a workgroup of the stage `reset` writes.
const RESET_WORDS: u32 = 1024;

fn module() -> Module {
    wgsl!("pass/turn.wgsl")
}

/// The modules of a program over cells.
pub fn modules() -> [Module; 2] {
    [module(), wgsl!("pass/queue.wgsl")]
}

/// The program that decides what the next dispatch visits.
pub fn arrange() -> Program {
    Program::new("arrange", vec![module(), wgsl!("pass/arrange.wgsl")])
}

fn over_cells(entry: &'static str, own: Module) -> Program {
    let [turn, queue] = modules();
    Program::new(entry, vec![wgsl!("pass/shared.wgsl"), turn, queue, own])
}

/// The program of the first stage of a block.
pub fn reset() -> Program {
    over_cells("reset", wgsl!("pass/reset.wgsl"))
}

/// The program of the last stage of a block.
pub fn census() -> Program {
    over_cells("census", wgsl!("pass/census.wgsl"))
}

/// Where the values of a block's cells are in one buffer of words: first the states of all
/// levels, the finest first, then the counts of work, the fronts, and the marks of the pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The block.
    pub block: Block,
    /// Divisor of the first level; 1 without levels.
    coarsest: u32,
    counted: bool,
    marked: bool,
}

impl Layout {
    /// The layout of a block.
    pub fn new(block: Block, coarsest: u32, counted: bool, marked: bool) -> Self {
        Self {
            block,
            coarsest,
            counted,
            marked,
        }
    }

    /// Cells along each axis at a divisor.
    pub fn cells(&self, divisor: u32) -> [u32; 2] {
        self.block.size.map(|n| n.div_ceil(divisor))
    }

    /// Number of cells at a divisor.
    pub fn count(&self, divisor: u32) -> u32 {
        self.cells(divisor).iter().product()
    }

    /// Cells of all levels that are finer than a divisor.
    fn finer(&self, divisor: u32) -> u32 {
        let finer = (0..divisor.ilog2()).map(|i| self.count(1 << i));
        finer.sum()
    }

    fn all(&self) -> u32 {
        self.finer(2 * self.coarsest)
    }

    /// Where the states of a level start.
    pub fn state(&self, divisor: u32) -> u32 {
        self.finer(divisor)
    }

    /// Where the counts of work of a level start.
    pub fn tally(&self, divisor: u32) -> u32 {
        self.all()
            + if self.counted {
                2 * self.finer(divisor)
            } else {
                0
            }
    }

    /// Where the fronts of a level start; for divisor 1, the depths.
    pub fn front(&self, divisor: u32) -> u32 {
        self.tally(2 * self.coarsest) + self.finer(divisor)
    }

    /// Where the marks of hits start.
    pub fn mark(&self) -> u32 {
        self.front(2 * self.coarsest)
    }

    /// Words of all values.
    pub fn words(&self) -> u32 {
        self.mark() + if self.marked { 3 * self.count(1) } else { 0 }
    }

    /// Words of the lists without their head: two queues and two lists of parents.
    pub fn list_words(&self) -> u32 {
        self.parents_at(2)
    }

    /// Where a list of parents starts. Stages take turns with the two.
    fn parents_at(&self, which: u32) -> u32 {
        2 * self.count(1) + which * self.count(2)
    }

    /// The stages of the block in order, without step limits of dispatches. `first` is the
    /// number of the first one, and `ray_steps` the step limit of a ray.
    pub fn stages(&self, passes: &[Pass], first: u32, ray_steps: u32) -> Vec<Stage> {
        let of_block = |divisor: u32| Stage {
            divisor,
            limit: 1,
            tiles: self.cells(divisor).map(|n| n.div_ceil(8)).iter().product(),
            origin: self.block.origin.map(|o| o / divisor),
            cells: self.cells(divisor),
            queues: [0, self.count(1)],
            front: self.front(divisor),
            state: self.state(divisor),
            tally: self.tally(divisor),
            mark: self.mark(),
            ..Stage::zeroed()
        };
        let reset = Stage {
            tiles: self.tally(2 * self.coarsest).div_ceil(RESET_WORDS),
            tally: self.all(),
            mark: self.tally(2 * self.coarsest),
            ..of_block(1)
        };
        let census = Stage {
            divisor: self.coarsest,
            ..of_block(1)
        };
        let of_pass = |pass: &Pass| match pass {
            Pass::March(level) => Stage {
                fudge: level.fudge as f32,
                limit: level.steps,
                ..self.under_parents(of_block(level.divisor))
            },
            Pass::Trace => Stage {
                limit: ray_steps,
                ..self.under_parents(of_block(1))
            },
            Pass::Color | Pass::Prepare(_) => of_block(1),
        };
        let passes = passes.iter().map(of_pass);
        let stages = std::iter::once(reset).chain(passes).chain([census]);
        let numbered = |(index, stage)| Stage {
            number: first + index,
            index,
            listed: self.parents_at(1 - index % 2),
            parents: self.parents_at(index % 2),
            ..stage
        };
        (0..).zip(stages).map(numbered).collect()
    }

    /// A stage that starts from its parents, unless its level is the coarsest.
    fn under_parents(&self, stage: Stage) -> Stage {
        if stage.divisor >= self.coarsest {
            return stage;
        }
        Stage {
            parent_width: self.cells(2 * stage.divisor)[0],
            parent_front: self.front(2 * stage.divisor),
            ..stage
        }
    }
}
