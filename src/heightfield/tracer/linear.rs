//! Relief mapping: a number of equal steps, then bisection (Policarpo, Oliveira, Comba 2005).
//! Twin: `wgsl/heightfield/tracer/linear.wgsl`.
//!
//! The steps divide the part of the ray inside the block, so that they always reach its end.
//! The tracer misses what is thinner than a step, and needs no map.

use crate::base::{outcome::Counts, shader::Module};
use crate::heightfield::height_surface::TracerParameters;
use crate::heightfield::tracer::refine::{Refine, refine, refine_over};
use crate::heightfield::tracer::{
    GridRay, LocalRay, Method, Step, Trace, Tracer, settings::TracerSettings,
};
use crate::wgsl;

/// Bisections by default: those of relief mapping.
const LINEAR_ROUNDS: u32 = 6;

/// Equal steps and bisections.
#[derive(Debug)]
pub struct LinearBinary;

impl Method for LinearBinary {
    fn numbers(&self, settings: &TracerSettings, _pixel: f64) -> TracerParameters {
        TracerParameters {
            steps: settings.own_steps().max(1),
            rounds: settings.rounds.unwrap_or(LINEAR_ROUNDS),
            ..TracerParameters::default()
        }
    }

    fn begin(&self, tracer: &Tracer, _: &LocalRay, trace: &mut Trace) {
        trace.left = tracer.numbers.steps;
    }

    fn advance(&self, tracer: &Tracer, grid: &mut GridRay<'_>, work: &mut Counts) -> Step {
        let TracerParameters { steps, rounds, .. } = tracer.numbers;
        let Trace { s, end, left, .. } = *grid.trace;
        // Only the first step can begin under the surface.
        if left == steps && refine_over(grid, s) <= 0.0 {
            return grid.hit(s);
        }
        let last = left <= 1;
        let next = if last {
            end
        } else {
            s + (end - s) / f64::from(left)
        };
        if (last && grid.trace.falls) || refine_over(grid, next) <= 0.0 {
            return refine(grid, [s, next], Refine::Binary, rounds, work);
        }
        if last {
            return grid.end();
        }
        grid.trace.left -= 1;
        grid.land(next);
        Step::Moving
    }

    fn modules(&self, _: &Tracer) -> Vec<Module> {
        vec![
            wgsl!("heightfield/tracer/refine.wgsl"),
            wgsl!("heightfield/tracer/linear.wgsl"),
        ]
    }
}
