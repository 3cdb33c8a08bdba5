//! Where the results of a block are on a device.

use bytemuck::{Pod, Zeroable};

use crate::pass::turn::{MOST_STAGES, Stage, StageKind};
use crate::plan::pyramid::Block;
use crate::plan::{Pass, UNTIL_TILE};

/// The head of the buffer of cells. Their values and the lists follow it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct CellsHead {
    /// Cells that still move.
    pub moving: u32,
    /// Cells whose children the next stage visits.
    pub parents: u32,
    /// Cells that were left out.
    pub wrong: u32,
    /// Cells of the finest cone level whose pixels have rays.
    pub traced: u32,
    /// Dispatches of each stage of the block.
    pub dispatches: [u32; MOST_STAGES],
}

/// Squares of four pixels that a workgroup of the stage `census` looks at.
const CENSUS_SQUARES: u32 = 1024;

/// Where the values of a block's cells are in one buffer of words: the states of all levels, the
/// finest first, the counts of work, the fronts, the marks, the light of the pixels, and the lists.
///
/// Blocks of different sizes use one buffer. Another word could be taken for the state of a cell
/// that was not visited. So all blocks reserve as many words for states as the largest one.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The block.
    pub block: Block,
    /// Divisor of the first level; 1 without levels.
    coarsest: u32,
    counted: bool,
    marked: bool,
    /// Values of four numbers per pixel: the light, the normals if they are kept, and the halves if
    /// tiles are judged.
    pixel_layers: u32,
    /// Words reserved for states.
    states: u32,
}

impl Layout {
    /// The layouts of the blocks of an image, of which the first is as large as any.
    pub fn of_blocks(
        blocks: &[Block],
        coarsest: u32,
        counted: bool,
        marked: bool,
        pixel_layers: u32,
    ) -> Vec<Self> {
        let layout = |block: &Block| Self {
            block: *block,
            coarsest,
            counted,
            marked,
            pixel_layers,
            states: 0,
        };
        let states = blocks.first().map_or(0, |b| layout(b).states_end());
        let reserved = |block| Self {
            states,
            ..layout(block)
        };
        blocks.iter().map(reserved).collect()
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

    /// Where the states of all levels end.
    pub fn states_end(&self) -> u32 {
        self.finer(2 * self.coarsest)
    }

    /// Where the states of a level start.
    pub fn state(&self, divisor: u32) -> u32 {
        self.finer(divisor)
    }

    /// Where the counts of work of a level start.
    pub fn tally(&self, divisor: u32) -> u32 {
        self.states
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

    /// Where the light of the pixels starts.
    pub fn light(&self) -> u32 {
        self.mark() + if self.marked { 3 * self.count(1) } else { 0 }
    }

    /// Where the last values of the pixels start: the halves, if tiles are judged.
    fn halves(&self) -> u32 {
        self.light() + 4 * self.pixel_layers.saturating_sub(1) * self.count(1)
    }

    /// Where the lists start: two queues and two lists of parents.
    pub fn lists(&self) -> u32 {
        self.light() + 4 * self.pixel_layers * self.count(1)
    }

    /// Where a list of parents starts. Stages take turns with the two.
    fn parents_at(&self, which: u32) -> u32 {
        self.lists() + 2 * self.count(1) + which * self.count(2)
    }

    /// Words of all values and lists.
    pub fn words(&self) -> u32 {
        self.parents_at(2)
    }

    /// The stages of the block, without step limits of dispatches. `first` is the number of the
    /// first one, and `ray_steps` the step limit of a ray.
    pub fn stages(&self, kinds: &[StageKind], first: u32, ray_steps: u32) -> Vec<Stage> {
        // Cone levels take turns with two lists of parents.
        let mut levels = 0;
        let mut stages = Vec::new();
        for (index, kind) in (0..).zip(kinds) {
            let stage = self.stage(kind, ray_steps);
            let lists = [
                self.parents_at(levels % 2),
                self.parents_at((levels + 1) % 2),
            ];
            levels += u32::from(matches!(kind, StageKind::Pass(Pass::March(_))));
            stages.push(Stage {
                number: first + index,
                index,
                listed: lists[1],
                parents: lists[0],
                ..stage
            });
        }
        stages
    }

    fn stage(&self, kind: &StageKind, ray_steps: u32) -> Stage {
        let at = |divisor: u32| Stage {
            divisor,
            limit: 1,
            tiles: self.cells(divisor).map(|n| n.div_ceil(8)).iter().product(),
            origin: self.block.origin.map(|o| o / divisor),
            cells: self.cells(divisor),
            queues: [self.lists(), self.lists() + self.count(1)],
            front: self.front(divisor),
            state: self.state(divisor),
            tally: self.tally(divisor),
            mark: self.mark(),
            light: self.light(),
            halves: self.halves(),
            until: -1.0,
            place: [0.5; 2],
            lens: [-1.0; 2],
            weight: 1.0,
            scale: 1.0,
            ..Stage::zeroed()
        };
        match kind {
            StageKind::Census => Stage {
                tiles: self.count(2).div_ceil(CENSUS_SQUARES),
                divisor: self.coarsest,
                ..at(1)
            },
            StageKind::Pass(Pass::March(level)) => Stage {
                fudge: level.fudge as f32,
                limit: level.steps,
                ..self.under_parents(at(level.divisor))
            },
            StageKind::Pass(Pass::Trace) => Stage {
                limit: ray_steps,
                ..self.under_parents(at(1))
            },
            StageKind::Judge => Stage {
                tiles: self.cells(UNTIL_TILE).iter().product(),
                ..at(1)
            },
            StageKind::Sketch(level) => at(level.divisor),
            StageKind::Pass(_) | StageKind::Develop => at(1),
        }
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
