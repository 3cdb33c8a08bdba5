//! Relaxed cones by a search along rays, in f64: Listing 18-2 of Policarpo and
//! Oliveira, Relaxed Cone Stepping for Relief Mapping (GPU Gems 3, 2007).
//! Twin: `wgsl/heightfield/conemap/generate/relaxed.wgsl`.
//!
//! For every pair of samples, a ray that starts at the top over the first and enters the
//! surface at the second is followed to where it comes out again; no cone may reach
//! that far. Three corrections make the listing work. Rays start slightly above the
//! top, because those to a sample of full height would be horizontal (0/0, and a NaN
//! that spreads). The search ends where the ray comes out. The rings end as soon as none
//! can matter.
//!
//! The result stays *unsound* with any number of steps: only rays from the top are tried, and
//! flatter ones leave a peak sooner; and steps over a long way are many texels each.

use crate::base::shader::Module;
use crate::heightfield::Patches;
use crate::heightfield::conemap::generate::{
    Apex, Best, ConeSearch, Cost, MapTask, SearchState, brute::beside, rings,
};
use crate::wgsl;
use glam::DVec2;

/// Height at which rays start: a little above the top, so that every ray goes down.
pub const START: f64 = 1.001;

/// The search along rays.
pub struct RaySearch;

impl ConeSearch for RaySearch {
    fn modules(&self, task: &MapTask<'_>) -> Vec<Module> {
        vec![
            task.cost().module(1.0),
            wgsl!("heightfield/conemap/generate/rings.wgsl"),
            wgsl!(
                "heightfield/conemap/generate/relaxed.wgsl",
                "RELAXED_START" = START
            ),
        ]
    }

    fn counts_steps(&self) -> bool {
        true
    }

    fn search(&self, task: &MapTask<'_>, _: usize, from: Apex, best: &mut Best) {
        let (steps, height) = (task.options.search_steps, from.height);
        let start = DVec2::from_array(from.place.map(f64::from));
        // A ray comes out farther away than the sample that it goes through, and lower.
        rings(task, from, best, |best, step| {
            let entry = beside(task, from.place, step);
            let squared = (step[0] * step[0] + step[1] * step[1]) as u32;
            if entry <= height || Cost::Cone.of(squared, entry - height) >= best.cost {
                return;
            }
            let way = DVec2::new(step[0] as f64, step[1] as f64);
            // Distance to the exit at the bottom, in distances of the two samples.
            let reach = entry / (START - entry);
            for k in 1..steps {
                let part = f64::from(k) / f64::from(steps);
                let z = entry * (1.0 - part);
                if z <= height {
                    // Wherever it comes out now, it is no higher than the apex.
                    return;
                }
                best.nodes = best.nodes.saturating_add(1);
                let far = 1.0 + reach * part;
                if task.heights.height(Patches::Bilinear, start + way * far) < z {
                    let cost = exit_cost(squared, entry, height, k, steps);
                    best.cost = best.cost.min(cost);
                    return;
                }
            }
        });
    }

    /// The note of this search is the step at which the ray came out.
    fn is_ambiguous(&self, _: &SearchState) -> bool {
        false
    }

    fn found_cost(&self, task: &MapTask<'_>, found: &SearchState, height: f64) -> f64 {
        let (entry, steps) = (f64::from(found.top), task.options.search_steps);
        exit_cost(found.squared, entry, height, found.note, steps)
    }

    /// Of the places that a device runs together, each may follow a ray to its end while the
    /// others wait.
    fn rounds(&self) -> u32 {
        8
    }
}

/// The cost of an exit after so many steps of a ray that enters at a squared distance
/// and a height.
fn exit_cost(squared: u32, entry: f64, height: f64, step: u32, steps: u32) -> f64 {
    let part = f64::from(step) / f64::from(steps);
    let far = 1.0 + entry / (START - entry) * part;
    let rise = entry * (1.0 - part) - height;
    f64::from(squared) * far * far / (rise * rise)
}
