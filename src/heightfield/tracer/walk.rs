//! The cone walk: it finds every first hit and skips most cells (docs/method.md, 4).
//! Twin: `wgsl/heightfield/tracer/walk.wgsl`.
//!
//! The apex A of a cell c is its highest point. The ratio of its cone is
//! `R = min (dist(c, c') + o) / (A' - A)` over all cells c' with a higher apex A', where `dist`
//! is the distance between the two squares and o is an offset. Take a ray at height z over c
//! that falls by g per texel of its way. It reaches a higher cell c' after x >= dist texels, at
//! the height `z - g x`. This height is above `A + (x + o) / R >= A'` while
//!
//! ```text
//! x < (R (z - A) - o) / (1 + g R)
//! ```
//!
//! and for every x if `1 + g R <= 0`. So the ray goes on by this way, or to the cell's exit if
//! that is farther. The patch of a cell is solved if the ray comes down to A in it. The offset
//! makes cones wider: it uses that a step always reaches the exit.

use crate::base::{outcome::Counts, shader::Module};
use crate::heightfield::tracer::{GridRay, Method, Step, Tracer, cone::cone_end};
use crate::wgsl;

/// The cone walk over cells.
#[derive(Debug)]
pub struct Walk;

impl Method for Walk {
    fn advance(&self, tracer: &Tracer, grid: &mut GridRay<'_>, _work: &mut Counts) -> Step {
        let node = grid.surface.node(grid.trace.cell, 0);
        let over = grid.over(&node);
        if over.gap <= 0.0 && grid.solve(over.to) {
            return Step::Hit;
        }
        let ratio = tracer.map.ratios[grid.surface.number(grid.trace.cell) as usize];
        let next = cone_end(grid, ratio, over.height, tracer.map.offset);
        grid.leave(&node, &over, next)
    }

    fn modules(&self, _: &Tracer) -> Vec<Module> {
        vec![
            wgsl!("heightfield/tracer/cone.wgsl"),
            wgsl!("heightfield/tracer/walk.wgsl"),
        ]
    }
}
