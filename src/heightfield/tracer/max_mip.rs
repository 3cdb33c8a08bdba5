//! Descent of the pyramid of maxima: it finds every first hit and needs no cone map (Tevs,
//! Ihrke, Seidel: Maximum Mipmaps for Fast, Accurate, and Scalable Dynamic Height Field
//! Rendering, I3D 2008). Twin: `wgsl/heightfield/tracer/max_mip.wgsl`.
//!
//! A step looks at one node of the pyramid. If the ray stays above the node's maximum, it goes
//! on to the next node, or to one that is twice as wide if the parent ends there too. Otherwise
//! it goes on to where it comes down to the maximum, and looks at the child there. In a cell it
//! solves the patch. The pyramid may have any size, and each tile begins one of its own.

use crate::base::{outcome::Counts, shader::Module};
use crate::heightfield::height_surface::Node;
use crate::heightfield::tracer::{
    GridRay, LocalRay, Method, Step, Trace, Tracer, cone::WALK_TRUST,
};
use crate::wgsl;

/// Descent of the pyramid of maxima.
#[derive(Debug)]
pub struct MaxMipTracer;

/// Whether the line by which the ray leaves a node also ends a node of the next level, or a tile.
fn ends_parent(grid: &GridRay<'_>, axis: usize, node: &Node) -> bool {
    let cells = grid.surface.cells()[axis] as i32;
    let local = grid.far_line(axis, node).rem_euclid(cells);
    local & ((2 << node.level) - 1) == 0
}

impl Method for MaxMipTracer {
    fn begin(&self, tracer: &Tracer, _: &LocalRay, trace: &mut Trace) {
        trace.level = tracer.surface.maxima().coarsest();
    }

    fn advance(&self, _: &Tracer, grid: &mut GridRay<'_>, _work: &mut Counts) -> Step {
        let node = grid.surface.node(grid.trace.cell, grid.trace.level);
        let over = grid.over(&node);
        if over.gap <= 0.0 {
            if node.level > 0 {
                grid.trace.level -= 1;
                // The ray meets nothing before it comes down to the maximum.
                let fall = -grid.ray.axis.z;
                if over.height > 0.0 && fall > 0.0 {
                    let next = grid.trace.s + over.height / fall * WALK_TRUST;
                    if next < over.to {
                        grid.land(next);
                    }
                }
                return Step::Moving;
            }
            if grid.solve(over.to) {
                return Step::Hit;
            }
        }
        if over.exit >= grid.trace.end {
            return grid.end();
        }
        grid.pass(&node, over.exit, over.axis);
        if node.level < grid.surface.maxima().coarsest() && ends_parent(grid, over.axis, &node) {
            grid.trace.level += 1;
        }
        Step::Moving
    }

    fn modules(&self, _: &Tracer) -> Vec<Module> {
        vec![wgsl!("heightfield/tracer/max_mip.wgsl")]
    }
}
