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

use std::sync::Arc;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::tracer::cone::cone_end;
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, TraceError, Tracer};
use crate::heightfield::tracer::grid::{grid_end, grid_leave, grid_over, grid_solve};
use crate::heightfield::tracer::kind::Parts;
use crate::heightfield::tracer::refine::{Refine, refine, refine_over};
use crate::wgsl;

/// The cone walk with relaxed cones.
#[derive(Debug)]
pub struct WalkRelaxed {
    surface: Arc<HeightSurface>,
    map: Arc<ConeMap>,
}

/// Makes the tracer.
pub fn make(parts: &Parts<'_>) -> Result<Arc<dyn Tracer>, TraceError> {
    Ok(Arc::new(WalkRelaxed {
        surface: parts.surface.clone(),
        map: parts.map()?,
    }))
}

/// A step of a rising ray at height z that meets nothing in its cell: to the exit of the
/// largest node that lies under it, or to its end if the whole surface lies under it.
fn relaxed_rise(surface: &HeightSurface, ray: &LocalRay, trace: &mut Trace, z: f64) -> Step {
    if z > f64::from(surface.maxima().top()) {
        return grid_end(surface, ray, trace);
    }
    let mut node = surface.node(trace.cell, 0);
    for level in 1..surface.maxima().levels.len() as u32 {
        let wider = surface.node(trace.cell, level);
        if wider.maximum >= z {
            break;
        }
        node = wider;
    }
    let over = grid_over(ray, trace, &node);
    grid_leave(surface, ray, trace, &node, &over, over.exit)
}

impl Tracer for WalkRelaxed {
    fn surface(&self) -> &HeightSurface {
        &self.surface
    }

    fn advance(&self, ray: &LocalRay, trace: &mut Trace, work: &mut Work) -> Step {
        let surface = &*self.surface;
        let node = surface.node(trace.cell, 0);
        let over = grid_over(ray, trace, &node);
        if over.gap <= 0.0 && grid_solve(surface, ray, trace, over.to) {
            return Step::Hit;
        }
        if ray.axis.z > 0.0 {
            return relaxed_rise(surface, ray, trace, over.z);
        }
        let ratio = self.map.ratios[surface.number(trace.cell) as usize];
        let next = cone_end(ray, trace, ratio, over.z - node.maximum, self.map.offset);
        if next > over.exit && over.exit < trace.end {
            let end = next.min(trace.end);
            let grounded = next >= trace.end && trace.falls;
            // The ray meets nothing in its cell, so that the bracket may begin at the exit.
            if grounded || refine_over(surface, ray, end) <= 0.0 {
                let bracket = [over.exit, end];
                refine(surface, ray, trace, bracket, Refine::Settle, work);
                return Step::Hit;
            }
        }
        grid_leave(surface, ray, trace, &node, &over, next)
    }

    fn map(&self) -> Option<&ConeMap> {
        Some(&self.map)
    }

    fn own_modules(&self) -> Vec<Module> {
        vec![
            wgsl!("heightfield/tracer/cone.wgsl"),
            wgsl!("heightfield/tracer/refine.wgsl"),
            wgsl!("heightfield/tracer/relaxed.wgsl"),
        ]
    }
}
