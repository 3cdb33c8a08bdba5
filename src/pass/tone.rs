//! From light to the bytes of a picture.
//!
//! The curve is monotonic, so a table of 255 radiances decides every byte. It is found in f64,
//! and f32 compares against it without an error. The curve in f32 says where to look.
//! Twin: `wgsl/pass/tone.wgsl`.

use glam::DVec3;

use crate::base::srgb::srgb;
use crate::pass::look::tone;

/// The byte of a radiance in one channel, under a factor of exposure, as files hold it.
pub fn byte(exposure: f64, x: f64) -> u8 {
    let shown = srgb(tone(exposure, DVec3::new(x, 0.0, 0.0))).x;
    (255.0 * shown + 0.5).min(255.0) as u8
}

/// The factor of exposure, and then the least radiance that is shown as each byte from 1 to 255,
/// infinite for one that no radiance reaches.
pub fn tone_steps(exposure: f64) -> [f32; 256] {
    std::array::from_fn(|b| {
        // The bits of floats that are not negative are in the order of the floats.
        let (mut below, mut above) = (0_u32, f32::INFINITY.to_bits());
        let reaches = |bits: u32| usize::from(byte(exposure, f64::from(f32::from_bits(bits)))) >= b;
        if b == 0 {
            return exposure as f32;
        }
        while above - below > 1 {
            let middle = below + (above - below) / 2;
            match reaches(middle) {
                true => above = middle,
                false => below = middle,
            }
        }
        f32::from_bits(above)
    })
}
