//! Slopes of the samples, for the channels that shade: central differences, one-sided
//! where an axis ends, round where it wraps.
//!
//! Dummer's program halves every difference once too often, so that his shader sees
//! half of the slope, and the one-sided ones twice; here they are what his text and his
//! shader take them for.

use crate::heightfield::heights::Heights;

/// Change of height per texel along x and along y (rows downwards), row by row.
pub fn slopes(heights: &Heights) -> Vec<[f64; 2]> {
    let [w, h] = heights.size().map(i64::from);
    let at = |x: i64, y: i64| {
        let along = |axis: usize, i: i64, height: &dyn Fn(i64) -> f64| {
            // An index beyond an end names the end itself: the difference is then of
            // neighbours, one texel apart, and of nothing on an axis of one sample.
            let n = i64::from(heights.size()[axis]);
            let apart = if heights.wrap()[axis] {
                2
            } else {
                (i + 1).min(n - 1) - (i - 1).max(0)
            };
            let rise = height(i + 1) - height(i - 1);
            if apart > 0 { rise / apart as f64 } else { 0.0 }
        };
        [
            along(0, x, &|i| heights.at(i, y)),
            along(1, y, &|i| heights.at(x, i)),
        ]
    };
    (0..h).flat_map(|y| (0..w).map(move |x| at(x, y))).collect()
}

/// Slope as a share: 0.5 flat, 0 and 1 half the height down or up over one texel, which
/// is what `(share - 0.5) * texture size` makes a slope per texture again.
pub(super) fn slope_share(slope: f64) -> f64 {
    0.5 + slope
}

/// Unit normal as shares: red x, green y upwards in the picture, as OpenGL wants it.
/// `depth` is the height of 1 in texels.
pub(super) fn normal_shares([x, y]: [f64; 2], depth: f64) -> [f64; 2] {
    let (nx, ny) = (-x * depth, y * depth);
    let length = (nx * nx + ny * ny + 1.0).sqrt();
    [nx, ny].map(|n| 0.5 + 0.5 * n / length)
}
