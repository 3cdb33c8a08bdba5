//! Descent of the pyramid of maxima: it finds every first hit and needs no cone map (Tevs,
//! Ihrke, Seidel: Maximum Mipmaps for Fast, Accurate, and Scalable Dynamic Height Field
//! Rendering, I3D 2008). Twin: `wgsl/heightfield/tracer/max_mip.wgsl`.
//!
//! A step looks at one node of the pyramid. If the ray stays above the node's maximum, it goes
//! on to the next node, or to one that is twice as wide if the parent ends there too. Otherwise
//! it goes on to where it comes down to the maximum, and looks at the child there. In a cell it
//! solves the patch. The pyramid may have any size, and each tile begins one of its own.

use std::sync::Arc;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::tracer::cone::WALK_TRUST;
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, TraceError, Tracer};
use crate::heightfield::tracer::grid::{
    far_line, grid_begin, grid_end, grid_land, grid_over, grid_pass, grid_solve,
};
use crate::heightfield::tracer::kind::Parts;
use crate::wgsl;

/// Descent of the pyramid of maxima.
#[derive(Debug)]
pub struct MaxMipTracer {
    surface: Arc<HeightSurface>,
}

/// Makes the tracer.
pub fn make(parts: &Parts<'_>) -> Result<Arc<dyn Tracer>, TraceError> {
    Ok(Arc::new(MaxMipTracer {
        surface: parts.surface.clone(),
    }))
}

impl MaxMipTracer {
    /// The coarsest level.
    fn top(&self) -> u32 {
        self.surface.maxima().levels.len() as u32 - 1
    }
}

/// Whether a line that ends a node of a level also ends one of the next level, or a tile.
fn ends_parent(surface: &HeightSurface, axis: usize, line: i32, level: u32) -> bool {
    let local = line.rem_euclid(surface.cells()[axis] as i32);
    local & ((2 << level) - 1) == 0
}

impl Tracer for MaxMipTracer {
    fn surface(&self) -> &HeightSurface {
        &self.surface
    }

    fn begin(&self, ray: &LocalRay, from: f64, to: f64) -> Trace {
        let mut trace = grid_begin(&self.surface, ray, from, to);
        trace.level = self.top();
        trace
    }

    fn advance(&self, ray: &LocalRay, trace: &mut Trace, _work: &mut Work) -> Step {
        let surface = &*self.surface;
        let node = surface.node(trace.cell, trace.level);
        let over = grid_over(ray, trace, &node);
        if over.gap <= 0.0 {
            if node.level > 0 {
                trace.level -= 1;
                // The ray meets nothing before it comes down to the maximum.
                let height = over.z - node.maximum;
                if height > 0.0 && ray.axis.z < 0.0 {
                    let next = trace.s + height / -ray.axis.z * WALK_TRUST;
                    if next < over.to {
                        grid_land(surface, ray, trace, next);
                    }
                }
                return Step::Moving;
            }
            if grid_solve(surface, ray, trace, over.to) {
                return Step::Hit;
            }
        }
        if over.exit >= trace.end {
            return grid_end(surface, ray, trace);
        }
        let line = far_line(ray, over.axis, node.low, node.high);
        grid_pass(surface, ray, trace, over.exit, over.axis, line);
        if node.level < self.top() && ends_parent(surface, over.axis, line, node.level) {
            trace.level += 1;
        }
        Step::Moving
    }

    fn own_modules(&self) -> Vec<Module> {
        vec![wgsl!("heightfield/tracer/max_mip.wgsl")]
    }
}
