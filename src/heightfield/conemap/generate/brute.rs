//! Dummer's search in growing rings, in f64 (Cone Step Mapping, 2006, appendix B).
//! Twin: `wgsl/heightfield/conemap/generate/brute.wgsl`.
//!
//! The search can end at a ring if a place on it, as high as the highest of all, would not
//! narrow the cone any more. This rule is in texels, so it holds for maps that are not
//! square, where the published rule ends too early. Indices wrap on both axes; the published
//! code leaves out the corners beyond two borders.

use crate::base::shader::Module;
use crate::heightfield::conemap::generate::{Apex, Best, ConeSearch, Cost, MapTask, rings};
use crate::wgsl;

/// The search in rings.
pub struct BruteForce;

impl ConeSearch for BruteForce {
    fn modules(&self, task: &MapTask<'_>) -> Vec<Module> {
        vec![
            task.cost().module(1.0),
            wgsl!("heightfield/conemap/generate/least_cost.wgsl"),
            wgsl!("heightfield/conemap/generate/rings.wgsl"),
            wgsl!("heightfield/conemap/generate/brute.wgsl"),
        ]
    }

    fn search(&self, task: &MapTask<'_>, _: usize, from: Apex, best: &mut Best) {
        rings(task, from, best, |best, step| {
            let rise = beside(task, from.place, step) - from.height;
            if rise > 0.0 {
                let squared = step[0] * step[0] + step[1] * step[1];
                let cost = Cost::Cone.of(squared as u32, rise);
                best.cost = best.cost.min(cost);
            }
        });
    }
}

/// The height at some steps from a place.
pub fn beside(task: &MapTask<'_>, from: [u32; 2], step: [i64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|a| i64::from(from[a]) + step[a]);
    task.heights.at(x, y)
}
