//! The reference tracer: it solves every cell on the ray's way exactly.
//!
//! It uses no apex, no cone and no pyramid to decide what to look at. All other tracers are
//! measured against it, and it is tested against closed forms. It has no shader of its own: on
//! a GPU the cone walk with ratios of 0 visits the same cells.

use crate::base::{outcome::Counts, shader::Module};
use crate::heightfield::tracer::{GridRay, Method, Step, Tracer};

/// Solves cell by cell.
#[derive(Debug)]
pub struct Reference;

impl Method for Reference {
    fn advance(&self, _: &Tracer, grid: &mut GridRay<'_>, _work: &mut Counts) -> Step {
        let node = grid.surface.node(grid.trace.cell, 0);
        let over = grid.over(&node);
        if grid.solve(over.to) {
            return Step::Hit;
        }
        grid.leave(&node, &over, over.exit)
    }

    fn modules(&self, _: &Tracer) -> Vec<Module> {
        Vec::new()
    }
}
