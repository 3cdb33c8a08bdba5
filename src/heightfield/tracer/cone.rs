//! Cones of a map: how far one lets a ray go on, and whether a map fits a tracer.
//! Twin: `wgsl/heightfield/tracer/cone.wgsl`.

use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::tracer::contract::{LocalRay, Trace, TraceError};
use crate::heightfield::tracer::grid::FAR;

/// The share of a ratio, and of the way that it gives, which is used. Ways are rounded by
/// about 1e-15 of their length here and by 1e-7 in f32; the shader has shares of its own.
pub const WALK_TRUST: f64 = 1.0 - 1e-13;

/// A quotient by less than this would reach [`FAR`].
const SLIGHT: f64 = 1e-25;

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

/// The parameter that a cone of the cone walk lets the ray go on to.
pub fn cone_end(ray: &LocalRay, trace: &Trace, ratio: f64, over: f64, offset: f64) -> f64 {
    trace.s + cone_way(ray, ratio * WALK_TRUST, over, offset) * WALK_TRUST
}

/// Checks that a map is of one of the kinds that a tracer uses, and was made for the surface.
pub fn check_map(
    tracer: &'static str,
    kinds: &[MapKind],
    surface: &HeightSurface,
    map: &ConeMap,
) -> Result<(), TraceError> {
    let kind = map.kind;
    if !kinds.contains(&kind) {
        return Err(TraceError::Kind { tracer, kind });
    }
    let over_cells = matches!(kind, MapKind::Walk | MapKind::WalkRelaxed);
    let wanted = if over_cells {
        surface.cells()
    } else {
        surface.heights().size()
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
    let (wanted, found) = (surface.heights().wrap(), map.wrap);
    if found != wanted {
        return Err(TraceError::Wrap { wanted, found });
    }
    let mut numbers = map.ratios.iter().chain([&map.offset]);
    match numbers.find(|n| !(n.is_finite() && **n >= 0.0)) {
        Some(n) => Err(TraceError::Number(*n)),
        None => Ok(()),
    }
}
