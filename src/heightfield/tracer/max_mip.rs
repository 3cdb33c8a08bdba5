//! First hits by the pyramid of maxima (Tevs, Ihrke, Seidel: Maximum Mipmaps for Fast,
//! Accurate, and Scalable Dynamic Height Field Rendering, I3D 2008): exact, needs no cone
//! map. Twin: `wgsl/heightfield/tracer/max_mip.wgsl`.
//!
//! A step looks at one node of the pyramid. A ray that stays above the node's maximum
//! while it is over it passes on to the next node, and to one that is twice as wide where
//! its parent ends there too. Else it goes on to where it comes down to the maximum and looks
//! at the child there, or in a cell solves the patch. The pyramid has levels of any size, and each tile begins one of its own.

use std::sync::Arc;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::height_surface::{HeightSurface, Numbers};
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, Tracer};
use crate::heightfield::tracer::course::{
    course_begin, course_end, course_exit, course_land, course_pass, course_solve,
};
use crate::heightfield::tracer::walk::WALK_TRUST;
use crate::wgsl;

/// Descent of the pyramid over a relief.
#[derive(Clone, Debug)]
pub struct MaxMipTracer {
    relief: Arc<HeightSurface>,
}

impl MaxMipTracer {
    /// The tracer of a relief.
    pub fn new(relief: Arc<HeightSurface>) -> Self {
        Self { relief }
    }
}

/// Whether the parents of two neighbouring nodes' levels part at a line, too: it ends a
/// node of the next level, or a tile.
fn parts(relief: &HeightSurface, axis: usize, line: i32, level: u32) -> bool {
    let local = line.rem_euclid(relief.cells()[axis] as i32);
    local & ((2 << level) - 1) == 0
}

impl Tracer for MaxMipTracer {
    fn begin(&self, ray: &LocalRay, from: f64, to: f64, _work: &mut Work) -> Trace {
        let mut trace = course_begin(&self.relief, ray, from, to);
        trace.level = self.relief.maxima().levels.len() as u32 - 1;
        trace
    }

    fn look(&self, ray: &LocalRay, trace: &mut Trace, _work: &mut Work) -> Step {
        let relief = &*self.relief;
        let level = trace.level;
        let node = relief.node(trace.cell, level);
        let (exit, axis) = course_exit(ray, node.low, node.high);
        let to = exit.min(trace.end);
        trace.gap = ray.height(trace.s).min(ray.height(to)) - node.maximum;
        if trace.gap <= 0.0 {
            if level > 0 {
                trace.level -= 1;
                // Down to the maximum nothing can be met.
                let over = ray.height(trace.s) - node.maximum;
                if over > 0.0 && ray.axis.z < 0.0 {
                    let next = trace.s + over / -ray.axis.z * WALK_TRUST;
                    if next < to {
                        course_land(relief, ray, trace, next);
                    }
                }
                return Step::Moving;
            }
            if course_solve(relief, ray, trace, to) {
                return Step::Hit;
            }
        }
        if exit >= trace.end {
            return course_end(relief, ray, trace);
        }
        let line = if ray.axis[axis] > 0.0 {
            node.high[axis]
        } else {
            node.low[axis]
        };
        course_pass(relief, ray, trace, exit, axis, line);
        let top = relief.maxima().levels.len() as u32 - 1;
        if level < top && parts(relief, axis, line, level) {
            trace.level += 1;
        }
        Step::Moving
    }

    fn modules(&self) -> Vec<Module> {
        let mut all = self.relief.modules();
        all.push(wgsl!("heightfield/tracer/max_mip.wgsl"));
        all
    }

    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)> {
        self.relief.buffers(None, Numbers::default())
    }
}
