//! The cone walk with relaxed cones: it finds every first hit, and rays that do not rise have
//! wider cones. Twin: `wgsl/heightfield/tracer/relaxed.wgsl`.
//!
//! A relaxed cone over a cell c is limited only by cells that fall away along some way from c.
//! A level or falling ray that comes under the surface where nothing falls stays under it until
//! the jump ends. So a jump crosses the surface at most once, and the height at its end tells
//! whether it did. (The idea is Policarpo and Oliveira's. The rule of falling edges is from Bán,
//! Valasek, Bálint, Vad, Robust Cone Step Mapping, EGSR 2024; here it applies to cells, with the
//! offset of the walk.) A rising ray may come out again anywhere. It goes from cell to cell, and
//! over nodes of the pyramid of maxima that lie under it.

use crate::base::{outcome::Counts, shader::Module};
use crate::heightfield::tracer::refine::{Refine, refine, refine_over};
use crate::heightfield::tracer::{GridRay, Method, Step, Tracer, cone::cone_end};
use crate::wgsl;

/// The cone walk with relaxed cones.
#[derive(Debug)]
pub struct WalkRelaxed;

/// A step of a rising ray that meets nothing in its cell: to the exit of the largest node that
/// lies under it, or to its end if the whole surface lies under it.
fn relaxed_rise(grid: &mut GridRay<'_>) -> Step {
    let z = grid.ray.height(grid.trace.s);
    let maxima = grid.surface.maxima();
    if z > f64::from(maxima.top()) {
        return grid.end();
    }
    let nodes = (1..maxima.levels.len() as u32).map(|n| grid.surface.node(grid.trace.cell, n));
    let under = nodes.take_while(|node| node.maximum < z).last();
    let node = under.unwrap_or(grid.surface.node(grid.trace.cell, 0));
    let over = grid.over(&node);
    grid.leave(&node, &over, over.exit)
}

impl Method for WalkRelaxed {
    fn advance(&self, tracer: &Tracer, grid: &mut GridRay<'_>, work: &mut Counts) -> Step {
        let node = grid.surface.node(grid.trace.cell, 0);
        let over = grid.over(&node);
        if over.gap <= 0.0 && grid.solve(over.to) {
            return Step::Hit;
        }
        if grid.ray.axis.z > 0.0 {
            return relaxed_rise(grid);
        }
        let ratio = tracer.map.ratios[grid.surface.number(grid.trace.cell) as usize];
        let next = cone_end(grid, ratio, over.height, tracer.map.offset);
        let (exit, end) = (over.exit, grid.trace.end);
        if next > exit && exit < end {
            let grounded = next >= end && grid.trace.falls;
            // The ray meets nothing in its cell, so that the bracket may begin at the exit.
            if grounded || refine_over(grid, next.min(end)) <= 0.0 {
                return refine(grid, [exit, next.min(end)], Refine::Patches, 0, work);
            }
        }
        grid.leave(&node, &over, next)
    }

    fn modules(&self, _: &Tracer) -> Vec<Module> {
        vec![
            wgsl!("heightfield/tracer/cone.wgsl"),
            wgsl!("heightfield/tracer/refine.wgsl"),
            wgsl!("heightfield/tracer/relaxed.wgsl"),
        ]
    }
}
