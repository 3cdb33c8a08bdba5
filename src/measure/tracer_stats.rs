//! What a tracer costs and misses over views of a surface: steps, skipped hits, rays that do not
//! converge, and the error of the hits.
//!
//! The surface is a quarter of its width deep. Rays enter at z = 1 anywhere over it and go down
//! in any direction at one angle to the vertical. They end at z = 0 or where the block ends. So
//! a ray travels `0.25 * width * tan(angle)` texels for each height that it falls, and its
//! parameter is the height that it has fallen. Starts and directions come from a low-discrepancy
//! sequence, which is the same in every run.

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::base::outcome::{Counts, Step};
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::tracer::{LocalRay, Tracer};

/// Depth of the surface as a part of its width: that of most published measurements.
pub const DEPTH: f64 = 0.25;

/// Steps after which a ray counts as unconverged.
pub const MOST_STEPS: u32 = 1024;

/// A hit this far behind the true one, in texels, counts as skipped.
pub const SKIPPED_BY: f64 = 1.0;

/// The real root of x^4 = x + 1. Its powers give the most even sequence in three dimensions
/// (Roberts 2018, the generalised golden ratio).
const EVEN: f64 = 1.220_744_084_605_759_6;

/// The figures of one tracer over one view. Shares are of all rays, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TracerStats {
    /// Mean steps of a ray; rounds of refinement are not counted.
    pub steps_mean: f64,
    /// The number of steps that is enough for 99 % of the rays.
    pub steps_p99: u32,
    /// Share of rays with a hit over [`SKIPPED_BY`] behind the true one, or with none.
    pub skipped: f64,
    /// Share of rays that run out of steps.
    pub unconverged: f64,
    /// Mean distance of the hits that are not skipped from the true ones, in texels of way.
    pub error_texels: f64,
}

/// Rays of a view at an angle to the vertical, in degrees below 90.
pub fn view_rays(surface: &HeightSurface, degrees: f64, count: u32) -> Vec<LocalRay> {
    let [w, h] = surface.domain().map(f64::from);
    let width = f64::from(surface.cells()[0]);
    let pace = DEPTH * width * degrees.to_radians().tan();
    let one = |i: u32| {
        let at = |power: i32| (0.5 + f64::from(i) * EVEN.powi(-power)).fract();
        let (sin, cos) = (std::f64::consts::TAU * at(3)).sin_cos();
        LocalRay {
            origin: DVec3::new(w * at(1), h * at(2), 1.0),
            axis: DVec3::new(pace * cos, pace * sin, -1.0),
        }
    };
    (0..count).map(one).collect()
}

/// How a ray ends: its state, its parameter, and its steps.
fn trace(tracer: &Tracer, ray: &LocalRay) -> (Step, f64, u32) {
    let mut work = Counts::default();
    let mut trace = tracer.begin(ray, 0.0, f64::MAX);
    for _ in 0..MOST_STEPS {
        if tracer.step(ray, &mut trace, &mut work) != Step::Moving {
            break;
        }
    }
    (trace.state, trace.s, work.evaluations)
}

/// The parameter of each ray's first hit, as an exact tracer finds it.
pub fn first_hits(exact: &Tracer, rays: &[LocalRay]) -> Vec<Option<f64>> {
    let one = |ray: &LocalRay| {
        let (step, s, _) = trace(exact, ray);
        (step == Step::Hit).then_some(s)
    };
    rays.par_iter().map(one).collect()
}

/// Traces all rays and compares them with their true first hits.
pub fn measure(tracer: &Tracer, rays: &[LocalRay], truths: &[Option<f64>]) -> TracerStats {
    let ends: Vec<_> = rays.par_iter().map(|ray| trace(tracer, ray)).collect();
    let mut steps: Vec<u32> = ends.iter().map(|e| e.2).collect();
    steps.sort_unstable();
    let (mut skipped, mut unconverged) = (0_u32, 0_u32);
    let (mut error, mut met) = (0.0, 0_u32);
    for ((ray, truth), (step, s, _)) in rays.iter().zip(truths).zip(&ends) {
        let pace = ray.axis.truncate().length();
        match (step, truth) {
            (Step::Hit, Some(truth)) if (s - truth) * pace > SKIPPED_BY => skipped += 1,
            (Step::Hit, Some(truth)) => {
                error += (s - truth).abs() * pace;
                met += 1;
            }
            (Step::Out, Some(_)) => skipped += 1,
            (Step::Moving | Step::Spent, _) => unconverged += 1,
            (_, None) => {}
        }
    }
    let count = rays.len().max(1) as f64;
    let last = steps.len().saturating_sub(1);
    TracerStats {
        steps_mean: steps.iter().map(|n| f64::from(*n)).sum::<f64>() / count,
        steps_p99: steps.get(last * 99 / 100).copied().unwrap_or(0),
        skipped: f64::from(skipped) / count,
        unconverged: f64::from(unconverged) / count,
        error_texels: error / f64::from(met.max(1)),
    }
}
