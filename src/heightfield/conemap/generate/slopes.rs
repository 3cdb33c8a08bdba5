//! Slopes at the samples, for the files that carry them beside the cones.

use crate::base::parallel::collect;
use crate::heightfield::Heights;

/// Rise per texel along both axes at each sample, by central differences; at a border
/// that does not wrap by the difference to the one neighbour that there is.
pub fn slopes(heights: &Heights) -> Vec<[f32; 2]> {
    let [w, h] = heights.size().map(i64::from);
    let slope = |i: usize| {
        let i = i as i64;
        let place = [i % w, i / w];
        [0, 1].map(|axis| {
            let (low, high) = beside(heights, axis, place);
            (high - low) * per_step(heights, axis, place[axis])
        })
    };
    collect(0..(w * h) as usize, 1, slope)
}

/// The heights of the two neighbours of a sample along an axis. At a border that
/// does not wrap one is the sample itself.
fn beside(heights: &Heights, axis: usize, place: [i64; 2]) -> (f32, f32) {
    let at = |step: i64| {
        let mut at = place;
        at[axis] += step;
        let [x, y] = [0, 1].map(|a| heights.index(a, at[a]) as usize);
        heights.data()[y * heights.size()[0] as usize + x]
    };
    (at(-1), at(1))
}

/// One over the steps between the two neighbours of the `i`-th place on an axis.
fn per_step(heights: &Heights, axis: usize, i: i64) -> f32 {
    let last = i64::from(heights.size()[axis]) - 1;
    let inside = heights.wrap()[axis] || (i > 0 && i < last);
    if inside { 0.5 } else { 1.0 }
}
