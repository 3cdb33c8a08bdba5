//! From light to the bytes of a picture.
//!
//! Between two neighbouring values of a byte there are 16 levels. Which of the two a level becomes
//! alternates from pixel to pixel, so that smooth skies have no bands (*dithering*).
//!
//! The curve is monotonic, so a table of radiances decides every level. It is found in f64,
//! and f32 compares against it without an error. The curve in f32 says where to look.
//! Twin: `wgsl/pass/tone.wgsl`.

use glam::DVec3;

use crate::base::srgb::linear;
use crate::pass::look::untone;
use crate::pass::tone_map::Tone;
use crate::plan::look::ToneMap;

/// The highest level, that of the byte 255.
pub const MOST_LEVEL: u16 = 16 * 255;

/// The level of a display value from 0 to 1.
pub fn level(shown: f64) -> u16 {
    // The cast saturates, and turns NaN into black.
    (f64::from(MOST_LEVEL) * shown.clamp(0.0, 1.0) + 0.5) as u16
}

/// The byte of a level in a pixel. The order of the pixels is that of the R2 sequence
/// (`crate::base::filter`), in units of 2^-32.
pub fn byte(level: u16, [x, y]: [u32; 2]) -> u8 {
    let at = x
        .wrapping_mul(0xC13F_A9A9)
        .wrapping_add(y.wrapping_mul(0x91E1_0DA6));
    ((u32::from(level) + (at >> 28)) >> 4).min(255) as u8
}

/// The factor of exposure, and then the least radiance that is shown as each level from 1 on,
/// infinite for one that no radiance reaches. If the tone mixes channels, exposure comes before
/// the table, and its factor is 1 here.
pub fn tone_steps(tone: &Tone) -> Vec<f32> {
    let exposure = if tone.mixes { 1.0 } else { tone.exposure };
    let of = |x: f32| level(tone.channels(DVec3::X * f64::from(x) * exposure).x);
    let step = |least: u16| {
        let shown = (f64::from(least) - 0.5) / f64::from(MOST_LEVEL);
        let light = linear(DVec3::splat(shown)).x;
        let light = match tone.map {
            ToneMap::Filmic => untone(light),
            _ => light,
        };
        // The inverse is a few units in the last place off.
        let mut x = (light / exposure) as f32;
        while x > 0.0 && of(x) >= least {
            x = x.next_down();
        }
        while x < f32::INFINITY && of(x) < least {
            x = x.next_up();
        }
        x
    };
    let factor = std::iter::once(exposure as f32);
    factor.chain((1..=MOST_LEVEL).map(step)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::look::Look;

    #[test]
    fn steps_are_where_the_level_changes() {
        let maps = [ToneMap::Filmic, ToneMap::None];
        for (exposure, map) in [-20.0, -3.0, 0.0, 0.37, 20.0]
            .iter()
            .zip(maps.iter().cycle())
        {
            let tone = Tone::of(&Look {
                exposure: *exposure,
                tone: *map,
                ..Look::default()
            });
            let steps = tone_steps(&tone);
            let of = |x: f32| level(tone.shown(DVec3::splat(f64::from(x))).x);
            for (least, x) in (1..).zip(&steps[1..]) {
                assert_eq!((of(*x), of(x.next_down())), (least, least - 1), "{tone:?}");
            }
        }
    }

    #[test]
    fn the_mean_of_neighbours_is_their_level() {
        for level in [0, 1, 777, 2040, MOST_LEVEL - 1, MOST_LEVEL] {
            let side = 64;
            let all = (0..side * side).map(|i| byte(level, [i % side, i / side]));
            let bytes: Vec<f64> = all.map(f64::from).collect();
            let mean = 16.0 * bytes.iter().sum::<f64>() / bytes.len() as f64;
            assert!((mean - f64::from(level)).abs() < 0.25, "{level} {mean}");
            let off = |b: &f64| (16.0 * b - f64::from(level)).abs();
            assert!(bytes.iter().all(|b| off(b) < 16.0));
        }
        // Black and white stay clean.
        assert!((0..99).all(|i| byte(0, [i, 7]) == 0 && byte(MOST_LEVEL, [i, 7]) == 255));
    }
}
