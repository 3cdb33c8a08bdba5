//! Relief mapping: a number of equal steps, then bisection (Policarpo, Oliveira, Comba 2005).
//! Twin: `wgsl/heightfield/tracer/linear.wgsl`.
//!
//! The steps divide the part of the ray inside the block, so that they always reach its end.
//! The tracer misses what is thinner than a step, and needs no map.

use std::sync::Arc;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::height_surface::{HeightSurface, TracerParameters};
use crate::heightfield::tracer::{
    GridRay, LocalRay, Parts, Step, Trace, TraceError, Tracer,
    grid::grid_begin,
    refine::{Refine, refine, refine_over},
};
use crate::wgsl;

/// Bisections by default: those of relief mapping.
const LINEAR_ROUNDS: u32 = 6;

/// Equal steps and bisections.
#[derive(Debug)]
pub struct LinearBinary {
    surface: Arc<HeightSurface>,
    steps: u32,
    rounds: u32,
}

/// Makes the tracer, with at least one step.
pub fn make(parts: &Parts<'_>) -> Result<Arc<dyn Tracer>, TraceError> {
    Ok(Arc::new(LinearBinary {
        surface: parts.surface.clone(),
        steps: parts.settings.own_steps().max(1),
        rounds: parts.settings.rounds.unwrap_or(LINEAR_ROUNDS),
    }))
}

impl Tracer for LinearBinary {
    fn surface(&self) -> &HeightSurface {
        &self.surface
    }

    fn begin(&self, ray: &LocalRay, from: f64, to: f64) -> Trace {
        let mut trace = grid_begin(&self.surface, ray, from, to);
        trace.left = self.steps;
        trace
    }

    fn advance(&self, grid: &mut GridRay<'_>, work: &mut Work) -> Step {
        let Trace { s, end, left, .. } = *grid.trace;
        // Only the first step can begin under the surface.
        if left == self.steps && refine_over(grid, s) <= 0.0 {
            return grid.hit(s);
        }
        let last = left <= 1;
        let next = if last {
            end
        } else {
            s + (end - s) / f64::from(left)
        };
        if (last && grid.trace.falls) || refine_over(grid, next) <= 0.0 {
            return refine(grid, [s, next], Refine::Binary(self.rounds), work);
        }
        if last {
            return grid.end();
        }
        grid.trace.left -= 1;
        grid.land(next);
        Step::Moving
    }

    fn parameters(&self) -> TracerParameters {
        TracerParameters {
            steps: self.steps,
            rounds: self.rounds,
            ..TracerParameters::default()
        }
    }

    fn own_modules(&self) -> Vec<Module> {
        vec![
            wgsl!("heightfield/tracer/refine.wgsl"),
            wgsl!("heightfield/tracer/linear.wgsl"),
        ]
    }
}
