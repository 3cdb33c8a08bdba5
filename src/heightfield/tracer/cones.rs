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

use glam::DVec3;

use crate::base::{named::named_enum, outcome::Counts, shader::Module};
use crate::heightfield::tracer::refine::{Refine, refine, refine_over};
use crate::heightfield::tracer::{
    GridRay, LocalRay, Method, Step, Trace, Tracer, cone::cone_way, settings::TracerSettings,
};
use crate::heightfield::{Patches, height_surface::TracerParameters, heights::bilinear};
use crate::wgsl;

named_enum! {
    /// How a ratio is read between the samples.
    #[derive(Default)]
    pub enum Lookup {
        /// The surface's height, and the ratio interpolated.
        #[default]
        Bilinear = "bilinear",
        /// Height and ratio of the nearest sample.
        Nearest = "nearest",
    }
}

/// Cone stepping over samples: what tells one of these tracers from another.
#[derive(Debug)]
pub struct Cones {
    /// Whether every patch on the way is solved.
    solves: bool,
    /// Whether the number of steps follows the view.
    by_view: bool,
    /// Factor on the steps that cones give.
    scale: f64,
    /// How a bracket becomes a hit.
    refine: Refine,
    /// Rounds of that.
    rounds: u32,
}

/// Cone steps, then the secant method. Each round at least halves the error and mostly reduces
/// it by much more, so that 4 are enough.
pub const SECANT: Cones = Cones {
    solves: false,
    by_view: false,
    scale: 1.0,
    refine: Refine::Secant,
    rounds: 4,
};

/// Cone steps, with every patch on the way solved.
pub const CSM_EXACT: Cones = Cones {
    solves: true,
    refine: Refine::Patches,
    rounds: 0,
    ..SECANT
};

/// A number of cone steps that follows the view.
pub const CSM_LOOP: Cones = Cones {
    by_view: true,
    ..SECANT
};

/// Cone steps, then bisection: 6 rounds as in listing 18-3.
pub const RCS_BINARY: Cones = Cones {
    refine: Refine::Binary,
    rounds: 6,
    ..SECANT
};

/// Longer cone steps, then bisection. With a factor of 1.5, what a step jumps over is mostly
/// still thinner than a texel.
pub const CSM_SCALED: Cones = Cones {
    scale: 1.5,
    ..RCS_BINARY
};

/// Height and ratio of the cone under the ray.
fn cone(tracer: &Tracer, grid: &GridRay<'_>) -> (f64, f64) {
    let (surface, axis, cell) = (grid.surface, grid.ray.axis, grid.trace.cell);
    let [u, v] = grid.uv(cell, grid.trace.s);
    let [x, y] = surface.tile_cell(cell).map(i64::from);
    // The sample of a box lies in its middle, those of a patch in its corners.
    let boxes = surface.patches() == Patches::Boxes;
    if tracer.lookup == Lookup::Nearest {
        let [i, j] = if boxes {
            [x, y]
        } else {
            [x + i64::from(u >= 0.5), y + i64::from(v >= 0.5)]
        };
        return (surface.heights().at(i, j), ratio(tracer, axis, i, j));
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
    let ratios = corners.map(|[x, y]| ratio(tracer, axis, i + x, j + y));
    (height, bilinear(ratios, u, v))
}

/// The ratio at a sample, for the side that the ray goes to.
fn ratio(tracer: &Tracer, axis: DVec3, i: i64, j: i64) -> f64 {
    let heights = tracer.surface.heights();
    let (i, j) = (heights.index(0, i), heights.index(1, j));
    let at = (j * tracer.map.size[0] + i) as usize;
    if tracer.map.kind.channels() == 1 {
        return tracer.map.ratios[at];
    }
    let side = if axis.x.abs() >= axis.y.abs() {
        usize::from(axis.x < 0.0)
    } else {
        2 + usize::from(axis.y < 0.0)
    };
    tracer.map.ratios[4 * at + side]
}

/// Steps of a ray that begins at s, if they follow the view. They are `steps * (0.5 + iz)`, where
/// iz is the horizontal part of the direction in texture widths and heights. At the distance
/// `lod` they are half of that, at twice the distance a third.
fn cones_steps(tracer: &Tracer, ray: &LocalRay, s: f64) -> u32 {
    let TracerParameters { steps, lod, .. } = tracer.numbers;
    let [w, h] = tracer.surface.cells().map(f64::from);
    let flat = (ray.axis.x / w).hypot(ray.axis.y / h);
    let whole = flat.hypot(ray.axis.z).max(f64::MIN_POSITIVE);
    let far = if lod > 0.0 {
        1.0 + s.max(0.0) / lod
    } else {
        1.0
    };
    let count = f64::from(steps) * (0.5 + flat / whole) / far;
    count.ceil().max(1.0) as u32
}

impl Method for Cones {
    fn numbers(&self, settings: &TracerSettings, _pixel: f64) -> TracerParameters {
        let is_solved = self.refine == Refine::Patches;
        TracerParameters {
            scale: settings.stretch.unwrap_or(self.scale),
            steps: settings.own_steps(),
            lod: settings.lod.filter(|_| self.by_view).unwrap_or(0.0),
            rounds: settings
                .rounds
                .filter(|_| !is_solved)
                .unwrap_or(self.rounds),
        }
    }

    fn begin(&self, tracer: &Tracer, ray: &LocalRay, trace: &mut Trace) {
        trace.left = match self.by_view {
            true => cones_steps(tracer, ray, trace.s),
            false => tracer.numbers.steps,
        };
    }

    fn advance(&self, tracer: &Tracer, grid: &mut GridRay<'_>, work: &mut Counts) -> Step {
        let Trace { s, end, .. } = *grid.trace;
        let node = grid.surface.node(grid.trace.cell, 0);
        let over = grid.over(&node);
        // Only the first step can begin under the surface.
        if refine_over(grid, s) <= 0.0 {
            return grid.hit(s);
        }
        if self.solves && over.gap <= 0.0 && grid.solve(over.to) {
            return Step::Hit;
        }
        let (height, ratio) = cone(tracer, grid);
        let way = cone_way(grid.ray, ratio, grid.ray.height(s) - height, 0.0);
        let next = (s + way * tracer.numbers.scale).max(over.exit).min(end);
        let grounded = next >= end && grid.trace.falls;
        if grounded || refine_over(grid, next) <= 0.0 {
            let low = if self.solves { over.to } else { s };
            return refine(grid, [low, next], self.refine, tracer.numbers.rounds, work);
        }
        grid.trace.state = grid.leave(&node, &over, next);
        if grid.trace.state == Step::Moving && grid.trace.left == 1 {
            grid.trace.state = Step::Spent;
        }
        grid.trace.left = grid.trace.left.saturating_sub(1);
        grid.trace.state
    }

    fn modules(&self, tracer: &Tracer) -> Vec<Module> {
        let set = |is: bool| f64::from(u8::from(is));
        vec![
            wgsl!("heightfield/tracer/cone.wgsl"),
            wgsl!("heightfield/tracer/refine.wgsl"),
            match tracer.map.kind.channels() {
                1 => wgsl!("heightfield/tracer/cones_one.wgsl"),
                _ => wgsl!("heightfield/tracer/cones_four.wgsl"),
            },
            wgsl!(
                "heightfield/tracer/cones.wgsl",
                "CONES_NEAREST" = set(tracer.lookup == Lookup::Nearest),
                "CONES_SOLVE" = set(self.solves),
                "CONES_VIEW" = set(self.by_view),
                "CONES_SECANT" = set(self.refine == Refine::Secant),
            ),
        ]
    }
}
