//! Slopes and normals as the channels that shade hold them.
//!
//! Dummer's program halves every difference once too often, so that his shader sees
//! half of the slope, and a quarter of it at borders; here slopes are what his text and
//! his shader take them for.

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
