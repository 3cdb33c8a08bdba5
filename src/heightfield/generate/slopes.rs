//! Slopes at the samples, for the files that carry them beside the cones.
//!
//! As Dummer's program stores slopes (Cone Step Mapping, 2006, appendix B) they are half of
//! what his shader takes them for, half of that again at borders, and make flat ground lean,
//! since 127 is not the middle of 0..=255. Files here have what the shader wants.

use rayon::prelude::*;

use crate::heightfield::heights::Heights;

/// Rise per texel along both axes at each sample, by central differences; at a border
/// that does not wrap by the difference to the one neighbour that there is.
pub fn slopes(heights: &Heights) -> Vec<[f64; 2]> {
    let [w, h] = heights.size().map(i64::from);
    let slope = |i: i64| {
        [0, 1].map(|axis| {
            let [low, high, steps] = beside(heights, axis, i % w, i / w);
            if steps > 0.0 {
                (high - low) / steps
            } else {
                0.0
            }
        })
    };
    (0..w * h).into_par_iter().map(slope).collect()
}

/// The heights of the two neighbours along an axis, and the steps between them.
fn beside(heights: &Heights, axis: usize, x: i64, y: i64) -> [f64; 3] {
    let last = i64::from(heights.size()[axis]) - 1;
    let here = [x, y][axis];
    let (down, up) = if heights.wrap()[axis] {
        (1, 1)
    } else {
        (here.min(1), (last - here).min(1))
    };
    let at = |step: i64| {
        let at = if axis == 0 {
            [x + step, y]
        } else {
            [x, y + step]
        };
        heights.at(at[0], at[1])
    };
    [at(-down), at(up), (down + up) as f64]
}
