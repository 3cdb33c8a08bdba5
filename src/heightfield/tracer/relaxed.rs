//! The cone walk with relaxed cones: exact for every ray, wider cones for those that do
//! not rise. Twin: `wgsl/heightfield/tracer/relaxed.wgsl`.
//!
//! Only cells that fall away along some way from c limit its cone. A ray that goes down
//! or level and comes under the surface where nothing falls stays under it until the jump
//! ends; so a jump crosses the surface once at most, and the height at its end says
//! whether it did (Policarpo and Oliveira's idea, with the rule of falling edges of Bán,
//! Valasek, Bálint, Vad, Robust Cone Step Mapping, EGSR 2024, on cells and with the offset
//! of the walk). A rising ray may come out again anywhere: it goes from cell to cell, and
//! over nodes of the maxima that lie under it.

use std::sync::Arc;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::{HeightSurface, Numbers};
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, TraceError, Tracer};
use crate::heightfield::tracer::course::{
    course_begin, course_cross, course_end, course_exit, course_land, course_pass, course_solve,
};
use crate::heightfield::tracer::refine::{Refine, refine, refine_over};
use crate::heightfield::tracer::walk::{WALK_TRUST, check_map, cone_way};
use crate::wgsl;

/// Walk with relaxed cones over a relief.
#[derive(Clone, Debug)]
pub struct WalkRelaxed {
    relief: Arc<HeightSurface>,
    map: Arc<ConeMap>,
}

impl WalkRelaxed {
    /// A walk with the cones of a map.
    ///
    /// # Errors
    /// The map is of another kind, or of another relief.
    pub fn new(relief: Arc<HeightSurface>, map: Arc<ConeMap>) -> Result<Self, TraceError> {
        check_map("walk-relaxed", &[MapKind::WalkRelaxed], &relief, &map)?;
        Ok(Self { relief, map })
    }
}

/// A step of a rising ray at height z, which meets nothing in its cell: to the exit of the
/// largest node that lies under it, or to the end where all of them do.
fn rise(relief: &HeightSurface, ray: &LocalRay, trace: &mut Trace, z: f64) -> Step {
    let mut node = relief.node(trace.cell, 0);
    let mut level = 0;
    let levels = relief.maxima().levels.len() as u32;
    while level + 1 < levels {
        let wider = relief.node(trace.cell, level + 1);
        if wider.maximum >= z {
            break;
        }
        (node, level) = (wider, level + 1);
    }
    let (exit, axis) = course_exit(ray, node.low, node.high);
    if exit >= trace.end || z > f64::from(relief.maxima().top()) {
        return course_end(relief, ray, trace);
    }
    if level == 0 {
        course_cross(ray, trace, exit, axis);
        return Step::Moving;
    }
    let forward = ray.axis[axis] > 0.0;
    let line = if forward { node.high } else { node.low }[axis];
    course_pass(relief, ray, trace, exit, axis, line);
    Step::Moving
}

impl Tracer for WalkRelaxed {
    fn begin(&self, ray: &LocalRay, from: f64, to: f64, _work: &mut Work) -> Trace {
        course_begin(&self.relief, ray, from, to)
    }

    fn look(&self, ray: &LocalRay, trace: &mut Trace, work: &mut Work) -> Step {
        let relief = &*self.relief;
        let apex = relief.apex(trace.cell);
        let (exit, axis) = course_exit(ray, trace.cell, trace.cell.map(|i| i + 1));
        let to = exit.min(trace.end);
        let z = ray.height(trace.s);
        trace.gap = z.min(ray.height(to)) - apex;
        if trace.gap <= 0.0 && course_solve(relief, ray, trace, to) {
            return Step::Hit;
        }
        if ray.axis.z > 0.0 {
            return rise(relief, ray, trace, z);
        }
        let ratio = self.map.ratios[relief.number(trace.cell) as usize] * WALK_TRUST;
        let next = trace.s + cone_way(ray, ratio, z - apex, self.map.offset) * WALK_TRUST;
        if exit >= trace.end {
            return course_end(relief, ray, trace);
        }
        if next <= exit {
            course_cross(ray, trace, exit, axis);
            return Step::Moving;
        }
        let next = next.min(trace.end);
        let ended = next >= trace.end;
        if (ended && trace.falls) || refine_over(relief, ray, next) <= 0.0 {
            refine(relief, ray, trace, [exit, next], Refine::Settle, work);
            return Step::Hit;
        }
        if ended {
            return course_end(relief, ray, trace);
        }
        course_land(relief, ray, trace, next);
        Step::Moving
    }

    fn modules(&self) -> Vec<Module> {
        let mut all = self.relief.modules();
        all.push(wgsl!("heightfield/tracer/cone.wgsl"));
        all.push(wgsl!("heightfield/tracer/refine.wgsl"));
        all.push(wgsl!("heightfield/tracer/relaxed.wgsl"));
        all
    }

    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)> {
        self.relief.buffers(Some(&self.map), Numbers::default())
    }
}
