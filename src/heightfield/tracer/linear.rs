//! Relief mapping: so many equal steps, then halvings (Policarpo, Oliveira, Comba 2005).
//! Twin: `wgsl/heightfield/tracer/linear.wgsl`.
//!
//! The steps divide the part of the ray inside the block, so that they always suffice; what
//! is thinner than a step is missed. Needs no map.

use std::sync::Arc;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::height_surface::{HeightSurface, Numbers};
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, Tracer};
use crate::heightfield::tracer::course::{course_begin, course_end, course_hit, course_land};
use crate::heightfield::tracer::refine::{Refine, refine, refine_over};
use crate::wgsl;

/// Steps, where nobody says otherwise.
pub const LINEAR_STEPS: u32 = 32;
/// Halvings, where nobody says otherwise: those of relief mapping.
pub const LINEAR_ROUNDS: u32 = 6;

/// Equal steps and halvings.
#[derive(Clone, Debug)]
pub struct LinearBinary {
    relief: Arc<HeightSurface>,
    steps: u32,
    rounds: u32,
}

impl LinearBinary {
    /// The tracer of a relief, with one step at least.
    pub fn new(relief: Arc<HeightSurface>, steps: u32, rounds: u32) -> Self {
        Self {
            relief,
            steps: steps.max(1),
            rounds,
        }
    }
}

impl Tracer for LinearBinary {
    fn begin(&self, ray: &LocalRay, from: f64, to: f64, _work: &mut Work) -> Trace {
        let mut trace = course_begin(&self.relief, ray, from, to);
        trace.left = self.steps;
        trace
    }

    fn look(&self, ray: &LocalRay, trace: &mut Trace, work: &mut Work) -> Step {
        let relief = &*self.relief;
        trace.gap = ray.height(trace.s) - relief.apex(trace.cell);
        // Only the first step can begin under the surface.
        if trace.left == self.steps && refine_over(relief, ray, trace.s) <= 0.0 {
            course_hit(relief, ray, trace, trace.s);
            return Step::Hit;
        }
        let last = trace.left <= 1;
        let next = if last {
            trace.end
        } else {
            trace.s + (trace.end - trace.s) / f64::from(trace.left)
        };
        if (last && trace.falls) || refine_over(relief, ray, next) <= 0.0 {
            let bracket = [trace.s, next];
            refine(
                relief,
                ray,
                trace,
                bracket,
                Refine::Binary(self.rounds),
                work,
            );
            return Step::Hit;
        }
        if last {
            return course_end(relief, ray, trace);
        }
        trace.left -= 1;
        course_land(relief, ray, trace, next);
        Step::Moving
    }

    fn modules(&self) -> Vec<Module> {
        let mut all = self.relief.modules();
        all.push(wgsl!("heightfield/tracer/refine.wgsl"));
        all.push(wgsl!("heightfield/tracer/linear.wgsl"));
        all
    }

    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)> {
        let numbers = Numbers {
            steps: self.steps,
            rounds: self.rounds,
            ..Numbers::default()
        };
        self.relief.buffers(None, numbers)
    }
}
