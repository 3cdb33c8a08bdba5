//! What a tracer costs and misses: steps, skipped hits, rays that do not converge, and the
//! error of those that do, over views of a relief at one angle.
//!
//! The relief is a quarter of its width deep. Rays enter at z = 1 anywhere over it, go down
//! any way at one angle to the vertical, and end at z = 0 or where the block ends: so one
//! height fallen is `0.25 * width * tan(angle)` texels of way, and the parameter of a ray
//! is the height that it has fallen. Starts and directions are points of a sequence of low
//! discrepancy, the same in every run.

use rayon::prelude::*;

use crate::base::work::Work;
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::tracer::{LocalRay, Step, Tracer};
use glam::DVec3;

/// Depth of the relief, as a part of its width: that of most of what was published.
pub const DEPTH: f64 = 0.25;

/// Steps after which a ray counts as unconverged.
pub const MOST_STEPS: u32 = 1024;

/// Way behind the true hit, in texels, from which on it counts as skipped.
pub const SKIPPED_BY: f64 = 1.0;

/// Real root of x^4 = x + 1: its powers step through three dimensions most evenly (Roberts
/// 2018, the generalised golden ratio).
const EVEN: f64 = 1.220_744_084_605_759_6;

/// The figures of one tracer over one view. Shares are of all rays, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracerStats {
    /// Steps of a ray; rounds of refinement are not counted.
    pub steps_mean: f64,
    /// 99 of 100 rays need at most so many.
    pub steps_p99: u32,
    /// Rays that report a hit over [`SKIPPED_BY`] behind the true one, or none.
    pub skipped: f64,
    /// Rays that run out of steps.
    pub unconverged: f64,
    /// Mean distance of the reported hits from the true ones, in texels of way, where
    /// nothing is skipped.
    pub error_texels: f64,
}

/// Rays of a view at an angle to the vertical, in degrees below 90.
pub fn view_rays(relief: &HeightSurface, degrees: f64, count: u32) -> Vec<LocalRay> {
    let [w, h] = relief.domain().map(f64::from);
    let width = f64::from(relief.cells()[0]);
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

/// How a ray ended: its state, its parameter, and its steps.
fn trace(tracer: &impl Tracer, ray: &LocalRay) -> (Step, f64, u32) {
    let mut work = Work::default();
    let mut walk = tracer.begin(ray, 0.0, f64::MAX, &mut work);
    let mut step = Step::Moving;
    for _ in 0..MOST_STEPS {
        step = tracer.step(ray, &mut walk, &mut work);
        if step != Step::Moving {
            break;
        }
    }
    (step, walk.s, work.evaluations)
}

/// The parameter of each ray's first hit, as a tracer known to be exact finds it.
pub fn first_hits(exact: &(impl Tracer + Sync), rays: &[LocalRay]) -> Vec<Option<f64>> {
    let one = |ray: &LocalRay| {
        let (step, s, _) = trace(exact, ray);
        (step == Step::Hit).then_some(s)
    };
    rays.par_iter().map(one).collect()
}

/// Traces all rays and compares with their true first hits.
pub fn survey(
    tracer: &(impl Tracer + Sync),
    rays: &[LocalRay],
    truths: &[Option<f64>],
) -> TracerStats {
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
