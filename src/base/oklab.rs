//! Oklab, in which equal steps look equally large (Ottosson 2020).

use glam::{DMat3, DVec3};

const TO_CONES: DMat3 = DMat3::from_cols(
    DVec3::new(0.412_221_470_8, 0.211_903_498_2, 0.088_302_461_9),
    DVec3::new(0.536_332_536_3, 0.680_699_545_1, 0.281_718_837_6),
    DVec3::new(0.051_445_992_9, 0.107_396_956_6, 0.629_978_700_5),
);
const TO_LAB: DMat3 = DMat3::from_cols(
    DVec3::new(0.210_454_255_3, 1.977_998_495_1, 0.025_904_037_1),
    DVec3::new(0.793_617_785_0, -2.428_592_205_0, 0.782_771_766_2),
    DVec3::new(-0.004_072_046_8, 0.450_593_709_9, -0.808_675_766_0),
);
const FROM_LAB: DMat3 = DMat3::from_cols(
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(0.396_337_777_4, -0.105_561_345_8, -0.089_484_177_5),
    DVec3::new(0.215_803_757_3, -0.063_854_172_8, -1.291_485_548_0),
);
const FROM_CONES: DMat3 = DMat3::from_cols(
    DVec3::new(4.076_741_662_1, -1.268_438_004_6, -0.004_196_086_3),
    DVec3::new(-3.307_711_591_3, 2.609_757_401_1, -0.703_418_614_7),
    DVec3::new(0.230_969_929_2, -0.341_319_396_5, 1.707_614_701_0),
);

/// Linear sRGB to lightness, green to red, and blue to yellow.
///
/// ```
/// # use conemarch::base::oklab::oklab;
/// # use glam::DVec3;
/// let red = oklab(DVec3::X);
/// assert!(red.abs_diff_eq(DVec3::new(0.627955, 0.224863, 0.125846), 1e-6));
/// ```
pub fn oklab(c: DVec3) -> DVec3 {
    TO_LAB * (TO_CONES * c).map(f64::cbrt)
}

/// Oklab to linear sRGB. What a screen cannot show is cut to no light.
///
/// ```
/// # use conemarch::base::oklab::{oklab, unoklab};
/// # use glam::DVec3;
/// for c in [DVec3::ZERO, DVec3::ONE, DVec3::new(0.9, 0.02, 0.4)] {
///     assert!(unoklab(oklab(c)).abs_diff_eq(c, 1e-6));
/// }
/// ```
pub fn unoklab(lab: DVec3) -> DVec3 {
    (FROM_CONES * (FROM_LAB * lab).map(|x| x * x * x)).max(DVec3::ZERO)
}
