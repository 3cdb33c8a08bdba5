//! Relaxed cones by searching along rays, in f64: Listing 18-2 of Policarpo and
//! Oliveira, Relaxed Cone Stepping for Relief Mapping (GPU Gems 3, 2007).
//! Twin: `wgsl/heightfield/conemap/generate/relaxed.wgsl`.
//!
//! For every pair of samples a ray that starts at the top over the first and enters the
//! surface at the second is followed to where it comes out again; no cone may reach
//! that far. The listing in these points made to work: rays start slightly above the
//! top, as those to a sample of full height would else be horizontal (0/0, and a NaN
//! that spreads); the search ends where the ray comes out; and rings end as soon as none
//! can matter.
//!
//! It stays *unsound*, however many its steps: only rays from the top are tried, and
//! flatter ones leave a peak sooner; and steps over a long way are many texels each.

use crate::heightfield::conemap::generate::brute::Scan;
use crate::heightfield::conemap::generate::cost::Cost;
use crate::heightfield::conemap::generate::scan::rings;
use crate::heightfield::conemap::generate::search::Best;
use crate::heightfield::heights::{Heights, Patches};
use glam::DVec2;

/// Height at which rays start: a little above the top, so that every ray goes down.
pub const START: f64 = 1.001;

/// Lowers the best to the least cost of all exits for a cone over a sample.
pub fn search(
    heights: &Heights,
    scan: &Scan<'_>,
    steps: u32,
    from: [u32; 2],
    height: f64,
    best: &mut Best,
) {
    let rise = scan.top - height;
    if rise <= 0.0 {
        return;
    }
    let start = DVec2::from_array(from.map(f64::from));
    // A ray comes out beyond the sample that it goes through, and lower.
    let go = |best: &Best, ring: u32| Cost::Cone.of(ring * ring, rise) < best.cost;
    rings(scan.axes, from, best, go, |best, step| {
        best.nodes = best.nodes.saturating_add(1);
        let entry = scan.beside(from, step);
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
            if heights.height(Patches::Bilinear, start + way * far) < z {
                let cost = exit_cost(squared, entry, height, k, steps);
                best.cost = best.cost.min(cost);
                return;
            }
        }
    });
}

/// The cost of an exit after so many steps of a ray that enters at a squared distance
/// and a height.
pub fn exit_cost(squared: u32, entry: f64, height: f64, step: u32, steps: u32) -> f64 {
    let part = f64::from(step) / f64::from(steps);
    let far = 1.0 + entry / (START - entry) * part;
    let rise = entry * (1.0 - part) - height;
    f64::from(squared) * far * far / (rise * rise)
}
