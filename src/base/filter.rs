//! The samples of a pixel: where their rays go through the image.
//!
//! The samples follow the R2 sequence (Roberts, The unreasonable effectiveness of quasirandom
//! sequences, 2018), so that any number of them is spread evenly. The inverse of the filter's
//! integral carries them to places with the density of the filter. Thus a pixel is the plain mean
//! of its samples.
//!
//! All pixels have the same places. The first one is the centre: a picture of one sample is
//! that of the centres, and rays next to each other stay so.

use glam::DVec2;
use std::f64::consts::TAU;

/// Radius of the filter in pixels.
pub const RADIUS: f64 = 1.5;
/// Coefficients of the window with four terms (Harris, On the use of windows for harmonic analysis
/// with the discrete Fourier transform, 1978, table 1).
const WINDOW: [f64; 4] = [0.35875, 0.48829, 0.14128, 0.01168];
/// The step of the R2 sequence: one over the real root of `x^3 = x + 1`, and its square.
const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_3);

/// The share of the filter below a place `t`, from 0 to 1 across it.
fn below(t: f64) -> f64 {
    let [a0, a1, a2, a3] = WINDOW;
    let wave = |a: f64, n: f64| a * (TAU * n * t).sin() / (TAU * n);
    t + (wave(a2, 2.0) - wave(a1, 1.0) - wave(a3, 3.0)) / a0
}

/// The place below which there is a share `u` of the filter, in pixels from its middle.
fn place(u: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    // Halved as often as an f64 has bits.
    for _ in 0..53 {
        let middle = 0.5 * (low + high);
        if below(middle) < u {
            low = middle;
        } else {
            high = middle;
        }
    }
    RADIUS * (low + high - 1.0)
}

/// Where the ray of a sample goes, in pixels from the centre of the pixel.
pub fn offset(sample: u32) -> DVec2 {
    match sample {
        0 => DVec2::ZERO,
        _ => {
            let u = (DVec2::splat(0.5) + f64::from(sample) * STEP).fract();
            DVec2::new(place(u.x), place(u.y))
        }
    }
}

/// Where on the lens the ray of a sample starts, uniform from 0 to 1 along both axes. The steps are
/// the fractions of the roots of 2 and 5. No small multiples of them and of those of the place in
/// the pixel add up to nearly a whole number.
pub fn lens_share(sample: u32) -> DVec2 {
    (f64::from(sample) * DVec2::new(0.414_213_562_373_095_1, 0.236_067_977_499_789_7)).fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_have_the_density_of_the_filter() {
        let window = |x: f64| {
            let wave = |n: f64| (TAU * n * (0.5 + 0.5 * x / RADIUS)).cos();
            let [a0, a1, a2, a3] = WINDOW;
            (a0 - a1 * wave(1.0) + a2 * wave(2.0) - a3 * wave(3.0)) / (2.0 * RADIUS * a0)
        };
        // Moments of the filter, by sums over a fine grid.
        let grid = |f: &dyn Fn(f64) -> f64| {
            let at = |i: i32| RADIUS * (f64::from(i) + 0.5) / 1e4;
            (-10_000..10_000)
                .map(|i| f(at(i)) * window(at(i)))
                .sum::<f64>()
                * RADIUS
                / 1e4
        };
        assert!((grid(&|_| 1.0) - 1.0).abs() < 1e-9);
        let count = 16384;
        let all: Vec<DVec2> = (0..count).map(offset).collect();
        let mean =
            |f: &dyn Fn(DVec2) -> f64| all.iter().map(|o| f(*o)).sum::<f64>() / f64::from(count);
        for power in [1, 2, 3, 4] {
            let expected = grid(&|x| x.powi(power));
            for axis in 0..2 {
                let found = mean(&|o| o[axis].powi(power));
                assert!(
                    (found - expected).abs() < 1e-3,
                    "{power} {axis} {found} {expected}"
                );
            }
        }
        assert!(mean(&|o| o.x * o.y).abs() < 1e-3);
        assert!(all.iter().all(|o| o.abs().max_element() < RADIUS));
        assert_eq!(all[0], DVec2::ZERO);
    }
}
