//! What a block is rendered from, and the numbers of each pass over it.

use crate::pass::look::Light;
use crate::pass::march::LevelUniform;
use crate::plan::pyramid::Block;
use crate::plan::{Extras, Pass, Plan};
use crate::scene::AnySolid;

/// What a block is rendered from.
pub struct Job<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// Its scene.
    pub scene: &'a AnySolid,
    /// Its light.
    pub light: Light,
    /// The step limit of a ray.
    pub ray_steps: u32,
    /// What to yield beside colour and depth.
    pub extras: Extras,
    /// The block.
    pub block: Block,
}

/// The numbers of one pass over one block.
pub struct Setup {
    /// Cells along each axis.
    pub cells: [u32; 2],
    /// The step limit of a cell.
    pub limit: u32,
    /// Cells per row of the parent level; 0 if there is none.
    pub parent_width: u32,
    /// The numbers of a cone level.
    pub level: Option<LevelUniform>,
}

impl Job<'_> {
    /// Cells along each axis of the block at a divisor.
    pub fn cells(&self, divisor: u32) -> [u32; 2] {
        self.block.size.map(|n| n.div_ceil(divisor))
    }

    /// The numbers of a pass.
    pub fn setup(&self, pass: Pass) -> Setup {
        let (divisor, limit) = match pass {
            Pass::March(level) => (level.divisor, level.steps),
            Pass::Trace => (1, self.ray_steps),
            Pass::Color | Pass::Prepare(_) => (1, 1),
        };
        let cells = self.cells(divisor);
        let has_parents = pass.marches() && divisor < self.plan.coarsest();
        let level = |fudge: f64| LevelUniform {
            divisor,
            fudge: fudge as f32,
            origin: self.block.origin.map(|o| o / divisor),
            cells,
        };
        Setup {
            cells,
            limit,
            parent_width: if has_parents {
                self.cells(2 * divisor)[0]
            } else {
                0
            },
            level: match pass {
                Pass::March(of) => Some(level(of.fudge)),
                _ => None,
            },
        }
    }
}
