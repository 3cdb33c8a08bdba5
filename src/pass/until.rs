//! Tiles whose picture is good enough get no more samples.
//!
//! The samples of a pixel are spread evenly, so their variance overestimates the error of their
//! mean. So the mean of their first half is compared with that of the second one: for independent
//! halves, a quarter of the squared difference is the variance of the mean of all. Evenly spread
//! samples do better. The error of a tile is the root mean square over its pixels and channels, of
//! display values. It is only looked at where the number of samples is a power of two, as the
//! sequences are spread evenly there. Twins: `wgsl/pass/until.wgsl`, `until_off.wgsl`, `judge.wgsl`.

use glam::DVec3;

use crate::pass::tone::{MOST_LEVEL, level};
use crate::pass::tone_map::Tone;
use crate::plan::UNTIL_LEAST;

/// The variance that rounding to levels adds to the error: two means are rounded, each with a
/// variance of 1/12, and a quarter of the sum counts. A tile without any difference has this.
const ROUNDING: f64 = 1.0 / 24.0;

/// Whether the sums after so many samples are kept, to compare with the next as many.
pub fn is_judged(samples: u32, plan_samples: u32) -> bool {
    samples.is_power_of_two() && samples >= UNTIL_LEAST / 2 && samples < plan_samples
}

/// The squared error in levels, less that of rounding, below which a tile ends after so many
/// samples. Below 0 it does not end.
pub fn bound(until: f64, samples: u32) -> f64 {
    match samples >= UNTIL_LEAST {
        true => (until * f64::from(MOST_LEVEL)).powi(2) - ROUNDING,
        false => -1.0,
    }
}

/// The squared error of a pixel in levels, summed over its channels. `half` is the sum of the light
/// of the first half of the samples, `all` that of all.
pub fn squared(tone: &Tone, half: [f32; 3], all: [f32; 3], samples: u32) -> f64 {
    let share = 2.0 / samples as f32;
    let light = |of: &dyn Fn(usize) -> f32| {
        let c = [0, 1, 2].map(|i| f64::from(of(i) * share));
        tone.shown(DVec3::from_array(c)).to_array().map(level)
    };
    let (first, second) = (light(&|i| half[i]), light(&|i| all[i] - half[i]));
    let pairs = first.into_iter().zip(second);
    let off = pairs.map(|(a, b)| (f64::from(a) - f64::from(b)).powi(2));
    0.25 * off.sum::<f64>()
}

/// The squared error of a pixel's alpha in levels. `half` is the number of hits among the first half
/// of the samples, `all` that among all.
pub fn squared_alpha(half: f32, all: f32, samples: u32) -> f64 {
    let share = f64::from(2.0 * half - all) * 2.0 / f64::from(samples);
    0.25 * (share * f64::from(MOST_LEVEL)).powi(2)
}
