//! Cosine and sine of an angle from -pi to pi. Those of WGSL are too coarse for rays.
//! Twin: `wgsl/base/angle.wgsl`.

use glam::DVec2;

/// The cosine, and the sine divided by the angle, for the square of half the angle.
pub fn angle_parts(half_squared: f64) -> [f64; 2] {
    let half = half_squared.sqrt();
    let (s, c) = half.sin_cos();
    let q = if half > 0.0 { s / half } else { 1.0 };
    [1.0 - 2.0 * s * s, q * c]
}

/// Cosine and sine.
pub fn angle_turn(a: f64) -> DVec2 {
    DVec2::from_angle(a)
}
