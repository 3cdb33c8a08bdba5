//! Cone stepping with one cone for each sample: the tracers of the papers, corrected.
//! Twins: `wgsl/heightfield/tracer/cones.wgsl`, with `cones_one.wgsl` or `cones_four.wgsl`.
//!
//! From the height z over a place of height h and ratio R, Dummer's step (Cone Step Mapping,
//! 2006) is `(z - h) R / (iz - dz R)` along a direction with the horizontal part iz. His text
//! has the wrong sign, his code has the right one. Four more things are corrected:
//!
//! - A step reaches at least the cell's edge; the papers add a texel to each step.
//! - The ray is first clipped to the block, so that rising and level rays end.
//! - The first place under the surface ends the search, and the hit is refined between it and
//!   the place before.
//! - A ray that has used up its steps above the surface has not converged, whatever the papers
//!   show there.
//!
//! None of this makes the cones safe. They keep clear of the samples, not of the surface between
//! them. What each tracer misses is measured (docs/heightfields.md).

use std::sync::Arc;

use glam::DVec3;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::{HeightSurface, TracerParameters};
use crate::heightfield::heights::{Patches, bilinear};
use crate::heightfield::tracer::{
    GridRay, LocalRay, Parts, Step, Trace, TraceError, Tracer,
    cone::cone_way,
    grid::grid_begin,
    refine::{Refine, refine, refine_over},
};
use crate::wgsl;

/// How a ratio is read between the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lookup {
    /// Height and ratio of the nearest sample.
    Nearest,
    /// The surface's height, and the ratio interpolated.
    #[default]
    Bilinear,
}

/// What tells one of these tracers from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeMethod {
    /// Whether every patch on the way is solved.
    solves: bool,
    /// Whether the number of steps follows the view.
    by_view: bool,
    /// Factor on the steps that cones give.
    scale: f64,
    /// How a bracket becomes a hit.
    refine: Refine,
}

/// Cone steps, then the secant method. Each round at least halves the error and mostly reduces
/// it by much more, so that 4 are enough.
pub const SECANT: ConeMethod = ConeMethod {
    solves: false,
    by_view: false,
    scale: 1.0,
    refine: Refine::Secant(4),
};

/// Cone steps, with every patch on the way solved.
pub const CSM_EXACT: ConeMethod = ConeMethod {
    solves: true,
    refine: Refine::Settle,
    ..SECANT
};

/// A number of cone steps that follows the view.
pub const CSM_LOOP: ConeMethod = ConeMethod {
    by_view: true,
    ..SECANT
};

/// Cone steps, then bisection: 6 rounds as in listing 18-3.
pub const RCS_BINARY: ConeMethod = ConeMethod {
    refine: Refine::Binary(6),
    ..SECANT
};

/// Longer cone steps, then bisection. With a factor of 1.5, what a step jumps over is mostly
/// still thinner than a texel.
pub const CSM_SCALED: ConeMethod = ConeMethod {
    scale: 1.5,
    ..RCS_BINARY
};

/// Cone stepping over samples.
#[derive(Debug)]
pub struct Cones {
    surface: Arc<HeightSurface>,
    map: Arc<ConeMap>,
    lookup: Lookup,
    /// Steps of a ray; 0 for no limit.
    steps: u32,
    /// The distance at which a ray has half as many; 0 for never.
    lod: f64,
    method: ConeMethod,
}

/// Makes a tracer that follows a method, with the numbers of a preset in place of its own.
///
/// # Errors
/// There is no map that it can use.
pub fn make(parts: &Parts<'_>, mut method: ConeMethod) -> Result<Arc<dyn Tracer>, TraceError> {
    let settings = parts.settings;
    method.refine = method.refine.with_rounds(settings.rounds);
    method.scale = settings.stretch.unwrap_or(method.scale);
    Ok(Arc::new(Cones {
        surface: parts.surface.clone(),
        map: parts.map()?,
        lookup: settings.lookup,
        steps: settings.own_steps(),
        lod: settings.lod.filter(|_| method.by_view).unwrap_or(0.0),
        method,
    }))
}

impl Cones {
    /// Height and ratio of the cone under the ray.
    fn cone(&self, grid: &GridRay<'_>) -> (f64, f64) {
        let (surface, axis, cell) = (grid.surface, grid.ray.axis, grid.trace.cell);
        let [u, v] = grid.uv(cell, grid.trace.s);
        let [x, y] = surface.tile_cell(cell).map(i64::from);
        // The sample of a box lies in its middle, those of a patch in its corners.
        let boxes = surface.patches() == Patches::Boxes;
        if self.lookup == Lookup::Nearest {
            let [i, j] = if boxes {
                [x, y]
            } else {
                [x + i64::from(u >= 0.5), y + i64::from(v >= 0.5)]
            };
            return (surface.heights().at(i, j), self.ratio(axis, i, j));
        }
        let height = surface.height(cell, u, v);
        let [[i, u], [j, v]] = [[u, x as f64], [v, y as f64]].map(|[f, i]| {
            let at = if boxes { i + f - 0.5 } else { i + f };
            // The far edge belongs to the cell.
            let low = if boxes { at.floor() } else { i };
            [low, at - low]
        });
        let (i, j) = (i as i64, j as i64);
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]];
        let ratios = corners.map(|[x, y]| self.ratio(axis, i + x, j + y));
        (height, bilinear(ratios, u, v))
    }

    /// The ratio at a sample, for the side that the ray goes to.
    fn ratio(&self, axis: DVec3, i: i64, j: i64) -> f64 {
        let heights = self.surface.heights();
        let (i, j) = (heights.index(0, i), heights.index(1, j));
        let at = (j * self.map.size[0] + i) as usize;
        if self.map.kind != MapKind::Quad {
            return self.map.ratios[at];
        }
        let side = if axis.x.abs() >= axis.y.abs() {
            usize::from(axis.x < 0.0)
        } else {
            2 + usize::from(axis.y < 0.0)
        };
        self.map.ratios[4 * at + side]
    }

    /// Steps of a ray that begins at s; 0 for no limit. If they follow the view, they are
    /// `steps * (0.5 + iz)`, where iz is the horizontal part of the direction in texture widths
    /// and heights. At the distance `lod` they are half of that, at twice the distance a third.
    fn cones_steps(&self, ray: &LocalRay, s: f64) -> u32 {
        if !self.method.by_view {
            return self.steps;
        }
        let [w, h] = self.surface.cells().map(f64::from);
        let flat = (ray.axis.x / w).hypot(ray.axis.y / h);
        let whole = flat.hypot(ray.axis.z).max(f64::MIN_POSITIVE);
        let far = if self.lod > 0.0 {
            1.0 + s.max(0.0) / self.lod
        } else {
            1.0
        };
        let count = f64::from(self.steps) * (0.5 + flat / whole) / far;
        count.ceil().max(1.0) as u32
    }
}

impl Tracer for Cones {
    fn surface(&self) -> &HeightSurface {
        &self.surface
    }

    fn begin(&self, ray: &LocalRay, from: f64, to: f64) -> Trace {
        let mut trace = grid_begin(&self.surface, ray, from, to);
        trace.left = self.cones_steps(ray, trace.s);
        trace
    }

    fn advance(&self, grid: &mut GridRay<'_>, work: &mut Work) -> Step {
        let Trace { s, end, .. } = *grid.trace;
        let ConeMethod {
            solves,
            scale,
            refine: how,
            ..
        } = self.method;
        let node = grid.surface.node(grid.trace.cell, 0);
        let over = grid.over(&node);
        // Only the first step can begin under the surface.
        if refine_over(grid, s) <= 0.0 {
            return grid.hit(s);
        }
        if solves && over.gap <= 0.0 && grid.solve(over.to) {
            return Step::Hit;
        }
        let (height, ratio) = self.cone(grid);
        let way = cone_way(grid.ray, ratio, grid.ray.height(s) - height, 0.0) * scale;
        let next = (s + way).max(over.exit).min(end);
        let grounded = next >= end && grid.trace.falls;
        if grounded || refine_over(grid, next) <= 0.0 {
            let low = if solves { over.to } else { s };
            return refine(grid, [low, next], how, work);
        }
        grid.trace.state = grid.leave(&node, &over, next);
        if grid.trace.state == Step::Moving && grid.trace.left == 1 {
            grid.trace.state = Step::Spent;
        }
        grid.trace.left = grid.trace.left.saturating_sub(1);
        grid.trace.state
    }

    fn map(&self) -> Option<&ConeMap> {
        Some(&self.map)
    }

    fn parameters(&self) -> TracerParameters {
        TracerParameters {
            scale: self.method.scale,
            steps: self.steps,
            lod: self.lod,
            rounds: self.method.refine.rounds(),
        }
    }

    fn own_modules(&self) -> Vec<Module> {
        let set = |is: bool| f64::from(u8::from(is));
        vec![
            wgsl!("heightfield/tracer/cone.wgsl"),
            wgsl!("heightfield/tracer/refine.wgsl"),
            if self.map.kind == MapKind::Quad {
                wgsl!("heightfield/tracer/cones_four.wgsl")
            } else {
                wgsl!("heightfield/tracer/cones_one.wgsl")
            },
            wgsl!(
                "heightfield/tracer/cones.wgsl",
                "CONES_NEAREST" = set(self.lookup == Lookup::Nearest),
                "CONES_SOLVE" = set(self.method.solves),
                "CONES_VIEW" = set(self.method.by_view),
                "CONES_SECANT" = set(matches!(self.method.refine, Refine::Secant(_))),
            ),
        ]
    }
}
