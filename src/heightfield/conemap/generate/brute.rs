//! Dummer's search in growing rings, in f64 (Cone Step Mapping, 2006, appendix B).
//! Twin: `wgsl/heightfield/conemap/generate/brute.wgsl`.
//!
//! A ring can be the last one once a place on it as high as the highest of all would
//! not narrow the cone any more. That rule is in texels, and so holds for maps that are
//! not square, for which the published one stops too early; indices wrap on both axes,
//! where the published ones leave out the corners beyond two borders.

use crate::heightfield::conemap::generate::cost::Cost;
use crate::heightfield::conemap::generate::scan::rings;
use crate::heightfield::conemap::generate::search::Best;
use crate::heightfield::heights::Axis;

/// A grid to scan.
pub struct Scan<'a> {
    /// Its axes.
    pub axes: [Axis; 2],
    /// Heights row by row.
    pub values: &'a [f32],
    /// The highest of them.
    pub top: f64,
}

impl Scan<'_> {
    /// The height at some steps from a place.
    pub fn beside(&self, from: [u32; 2], step: [i64; 2]) -> f64 {
        let at = |a: usize| {
            let n = i64::from(self.axes[a].count);
            (i64::from(from[a]) + step[a]).rem_euclid(n) as usize
        };
        f64::from(self.values[at(1) * self.axes[0].count as usize + at(0)])
    }

    /// Lowers the best to the least cost for a cone over a sample.
    pub fn run(&self, from: [u32; 2], height: f64, best: &mut Best) {
        let rise = self.top - height;
        if rise <= 0.0 {
            return;
        }
        let go = |best: &Best, ring: u32| Cost::Cone.of(ring * ring, rise) < best.cost;
        rings(self.axes, from, best, go, |best, step| {
            best.nodes = best.nodes.saturating_add(1);
            let rise = self.beside(from, step) - height;
            if rise > 0.0 {
                let squared = step[0] * step[0] + step[1] * step[1];
                let cost = Cost::Cone.of(squared as u32, rise);
                best.cost = best.cost.min(cost);
            }
        });
    }
}
