//! The truth: every cell on the way, one by one, each with the exact solve of its patch.
//!
//! No apex, no cone, no pyramid: nothing that could be made wrong decides what is looked
//! at. It is what all tracers are measured against, and itself tested against closed
//! forms. Its only twin is the walk with cones of ratio 0.

use std::sync::Arc;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::{HeightSurface, Numbers};
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, Tracer};
use crate::heightfield::tracer::course::{
    course_begin, course_cross, course_end, course_exit, course_solve,
};
use crate::wgsl;

/// Cell by cell.
#[derive(Clone, Debug)]
pub struct Oracle {
    relief: Arc<HeightSurface>,
}

impl Oracle {
    /// The oracle of a relief.
    pub fn new(relief: Arc<HeightSurface>) -> Self {
        Self { relief }
    }
}

impl Tracer for Oracle {
    fn begin(&self, ray: &LocalRay, from: f64, to: f64, _work: &mut Work) -> Trace {
        course_begin(&self.relief, ray, from, to)
    }

    fn look(&self, ray: &LocalRay, trace: &mut Trace, _work: &mut Work) -> Step {
        let relief = &*self.relief;
        let (exit, axis) = course_exit(ray, trace.cell, trace.cell.map(|i| i + 1));
        let to = exit.min(trace.end);
        trace.gap = ray.height(trace.s).min(ray.height(to)) - relief.apex(trace.cell);
        if course_solve(relief, ray, trace, to) {
            return Step::Hit;
        }
        if exit >= trace.end {
            return course_end(relief, ray, trace);
        }
        course_cross(ray, trace, exit, axis);
        Step::Moving
    }

    fn modules(&self) -> Vec<Module> {
        let mut all = self.relief.modules();
        all.push(wgsl!("heightfield/tracer/cone.wgsl"));
        all.push(wgsl!("heightfield/tracer/walk.wgsl"));
        all
    }

    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)> {
        let size = self.relief.cells();
        let none = ConeMap {
            kind: MapKind::Walk,
            size,
            wrap: self.relief.heights().wrap(),
            offset: 0.0,
            ratios: vec![0.0; size[0] as usize * size[1] as usize],
        };
        self.relief.buffers(Some(&none), Numbers::default())
    }
}
