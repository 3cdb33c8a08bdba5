//! The cone walk: exact first hits, most cells skipped (docs/method.md, 4).
//! Twin: `wgsl/heightfield/tracer/walk.wgsl`.
//!
//! Cell c has the apex A, its highest point, and the ratio
//! `R = min (dist(c, c') + o) / (A' - A)` over the cells c' with a higher apex A', with
//! the distance between the two squares and an offset o. A ray at height z over c that
//! falls by g per texel of way reaches a higher cell c' after x >= dist, at the height
//! `z - g x`, which lies above `A + (x + o) / R >= A'` while
//!
//! ```text
//! x < (R (z - A) - o) / (1 + g R)
//! ```
//!
//! and for all x where `1 + g R <= 0`. So it travels on by the larger of that and the
//! cell's exit, and solves the patch of the cell where it comes down to A in it. The
//! offset takes from every cone what the exit gives back, and lets them be wider.

use std::sync::Arc;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::{HeightSurface, Numbers};
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, TraceError, Tracer};
use crate::heightfield::tracer::course::{
    FAR, course_begin, course_cross, course_end, course_exit, course_land, course_solve,
};
use crate::wgsl;

/// Share of a ratio that is used, and of the way that it gives: ways are rounded by
/// about 1e-15 of themselves here, by 1e-7 in f32, whose own shares the shader has.
pub const WALK_TRUST: f64 = 1.0 - 1e-13;

/// A quotient below this would reach [`FAR`].
const SLIGHT: f64 = 1e-25;

/// Cone walk over a relief.
#[derive(Clone, Debug)]
pub struct Walk {
    relief: Arc<HeightSurface>,
    map: Arc<ConeMap>,
}

impl Walk {
    /// A walk with the cones of a map.
    ///
    /// # Errors
    /// The map is of another kind, or of another relief.
    pub fn new(relief: Arc<HeightSurface>, map: Arc<ConeMap>) -> Result<Self, TraceError> {
        check_map("walk", &[MapKind::Walk], &relief, &map)?;
        Ok(Self { relief, map })
    }
}

/// Whether a map is of one of the kinds and of the relief.
pub(crate) fn check_map(
    tracer: &'static str,
    kinds: &[MapKind],
    relief: &HeightSurface,
    map: &ConeMap,
) -> Result<(), TraceError> {
    let kind = map.kind;
    if !kinds.contains(&kind) {
        return Err(TraceError::Kind { tracer, kind });
    }
    let over_cells = matches!(kind, MapKind::Walk | MapKind::WalkRelaxed);
    let wanted = if over_cells {
        relief.cells()
    } else {
        relief.heights().size()
    };
    let found = map.size;
    if found != wanted {
        return Err(TraceError::Size { wanted, found });
    }
    let cones = if kind == MapKind::Quad { 4 } else { 1 };
    let wanted = wanted[0] as usize * wanted[1] as usize * cones;
    let found = map.ratios.len();
    if found != wanted {
        return Err(TraceError::Count { wanted, found });
    }
    let (wanted, found) = (relief.heights().wrap(), map.wrap);
    if found != wanted {
        return Err(TraceError::Wrap { wanted, found });
    }
    let mut numbers = map.ratios.iter().chain([&map.offset]);
    match numbers.find(|n| !(n.is_finite() && **n >= 0.0)) {
        Some(n) => Err(TraceError::Number(*n)),
        None => Ok(()),
    }
}

/// How far a cone lets the ray go on, in s: 0 for not at all, [`FAR`] for without limit.
/// `over` is the height above the apex.
pub fn cone_way(ray: &LocalRay, ratio: f64, over: f64, offset: f64) -> f64 {
    let reach = ratio * over - offset;
    if reach <= 0.0 {
        return 0.0;
    }
    let pace = ray.axis.truncate().length() - ray.axis.z * ratio;
    if pace <= SLIGHT {
        return FAR;
    }
    reach / pace
}

impl Tracer for Walk {
    fn begin(&self, ray: &LocalRay, from: f64, to: f64, _work: &mut Work) -> Trace {
        course_begin(&self.relief, ray, from, to)
    }

    fn look(&self, ray: &LocalRay, trace: &mut Trace, _work: &mut Work) -> Step {
        let relief = &*self.relief;
        let apex = relief.apex(trace.cell);
        let (exit, axis) = course_exit(ray, trace.cell, trace.cell.map(|i| i + 1));
        let to = exit.min(trace.end);
        let z = ray.height(trace.s);
        trace.gap = z.min(ray.height(to)) - apex;
        if trace.gap <= 0.0 && course_solve(relief, ray, trace, to) {
            return Step::Hit;
        }
        let ratio = self.map.ratios[relief.number(trace.cell) as usize] * WALK_TRUST;
        let way = cone_way(ray, ratio, z - apex, self.map.offset);
        let next = trace.s + way * WALK_TRUST;
        if next.max(exit) >= trace.end {
            return course_end(relief, ray, trace);
        }
        if next > exit {
            course_land(relief, ray, trace, next);
        } else {
            course_cross(ray, trace, exit, axis);
        }
        Step::Moving
    }

    fn modules(&self) -> Vec<Module> {
        let mut all = self.relief.modules();
        all.push(wgsl!("heightfield/tracer/cone.wgsl"));
        all.push(wgsl!("heightfield/tracer/walk.wgsl"));
        all
    }

    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)> {
        self.relief.buffers(Some(&self.map), Numbers::default())
    }
}
