//! The sRGB transfer function (IEC 61966-2-1).

use glam::DVec3;

/// The shares of red, green and blue in luminance (ITU-R BT.709).
pub const LUMA: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// sRGB to linear.
///
/// ```
/// # use conemarch::base::srgb::linear;
/// # use glam::DVec3;
/// assert!((linear(DVec3::splat(0.5)).x - 0.214_041_14).abs() < 1e-7);
/// ```
pub fn linear(c: DVec3) -> DVec3 {
    c.map(|x| {
        if x <= 0.040_45 {
            x / 12.92
        } else {
            ((x + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// Linear to sRGB: the inverse of [`linear`].
///
/// ```
/// # use conemarch::base::srgb::{linear, srgb};
/// # use glam::DVec3;
/// for i in 0..=100 {
///     let x = f64::from(i) / 100.0;
///     assert!((srgb(linear(DVec3::splat(x))).x - x).abs() < 1e-9);
/// }
/// ```
pub fn srgb(c: DVec3) -> DVec3 {
    c.map(|x| {
        if x <= 0.003_130_8 {
            12.92 * x
        } else {
            1.055 * x.powf(1.0 / 2.4) - 0.055
        }
    })
}
