//! Cones of a map: how far one lets a ray go on, and whether a map fits a tracer.
//! Twin: `wgsl/heightfield/tracer/cone.wgsl`.

use crate::heightfield::HeightSurface;
use crate::heightfield::tracer::settings::TracerCones;
use crate::heightfield::tracer::{GridRay, LocalRay, TraceError, TracerKind, grid::FAR};

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
pub fn cone_end(grid: &GridRay<'_>, ratio: f64, over: f64, offset: f64) -> f64 {
    grid.trace.s + cone_way(grid.ray, ratio * WALK_TRUST, over, offset) * WALK_TRUST
}

/// Checks that a map is of a kind that a tracer can use, and was made for the surface.
pub fn check_map(
    tracer: TracerKind,
    surface: &HeightSurface,
    cones: &TracerCones,
) -> Result<(), TraceError> {
    let map = cones.map();
    let kind = map.kind;
    if !tracer.facts().kinds.contains(&kind) {
        let tracer = tracer.name();
        return Err(TraceError::Kind { tracer, kind });
    }
    let heights = surface.heights();
    let [w, h] = kind.places(heights.size(), heights.wrap(), surface.patches());
    let ratios = w as usize * h as usize * kind.channels();
    let debug = |value: &dyn std::fmt::Debug| format!("{value:?}");
    for (what, wanted, found) in [
        ("places", debug(&[w, h]), debug(&map.size)),
        ("cones", debug(&ratios), debug(&map.ratios.len())),
        ("wrapping axes", debug(&heights.wrap()), debug(&map.wrap)),
    ] {
        if found != wanted {
            return Err(TraceError::Misfit {
                what,
                wanted,
                found,
            });
        }
    }
    match cones.wrong_number() {
        Some(n) => Err(TraceError::Number(n)),
        None => Ok(()),
    }
}
