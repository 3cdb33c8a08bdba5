//! The numbers of one pass over one block.

use crate::pass::look::Light;
use crate::pass::march::LevelUniform;
use crate::plan::pyramid::Block;
use crate::plan::{Extras, Pass, Plan};
use crate::scene::AnySolid;

/// What a block is rendered from.
pub struct Job<'a> {
    /// What to render.
    pub plan: &'a Plan,
    /// Its scene, made ready.
    pub scene: &'a AnySolid,
    /// Its light.
    pub light: Light,
    /// Steps that a ray may do.
    pub ray_steps: u32,
    /// What it yields.
    pub extras: Extras,
    /// The pixels of this job.
    pub block: Block,
}

/// Numbers of one pass over one block.
pub struct Setup {
    /// Cells along each axis.
    pub cells: [u32; 2],
    /// Steps that a cell may do.
    pub limit: u32,
    /// Cells per row of the parent level, 0 without one.
    pub parent_width: u32,
    /// What the shader must know of a cone level.
    pub level: Option<LevelUniform>,
}

impl Job<'_> {
    /// Cells of a divisor in the block.
    pub fn cells(&self, divisor: u32) -> [u32; 2] {
        self.block.size.map(|n| n.div_ceil(divisor))
    }

    /// The numbers of a pass.
    pub fn setup(&self, pass: Pass) -> Setup {
        let parent_width = |divisor: u32| {
            if divisor < self.plan.pyramid().coarsest() {
                self.cells(2 * divisor)[0]
            } else {
                0
            }
        };
        match pass {
            Pass::March(level) => {
                let cells = self.cells(level.divisor);
                Setup {
                    cells,
                    limit: level.steps,
                    parent_width: parent_width(level.divisor),
                    level: Some(LevelUniform {
                        divisor: level.divisor,
                        fudge: level.fudge as f32,
                        origin: self.block.origin.map(|o| o / level.divisor),
                        cells,
                    }),
                }
            }
            Pass::Trace => Setup {
                cells: self.block.size,
                limit: self.ray_steps,
                parent_width: parent_width(1),
                level: None,
            },
            Pass::Color | Pass::Prepare(_) => Setup {
                cells: self.block.size,
                limit: 1,
                parent_width: 0,
                level: None,
            },
        }
    }
}
