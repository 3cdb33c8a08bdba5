//! The variance of a pixel's luminance, for denoisers. It is that of the mean of its samples, computed
//! as if they were independent. They are spread evenly, so the error of the mean is smaller. The GPU
//! does the same in `wgsl/pass/color.wgsl`.

use glam::DVec3;

use crate::base::srgb::LUMA;

/// What a sample adds to the sum of the squared deviations from the mean (Welford 1962). `sum` is that
/// of the one or more samples before.
pub fn spread_of(sum: [f32; 3], own: DVec3, before: u32) -> f32 {
    let n = f64::from(before);
    let off = LUMA.dot(own - DVec3::from(sum.map(f64::from)) / n);
    (off * off * n / (n + 1.0)) as f32
}

/// The variance of the mean of two or more samples, from the sum of the squared deviations.
pub fn variance_of(spread: f32, samples: u32) -> f32 {
    let n = samples as f32;
    spread / (n * (n - 1.0))
}
