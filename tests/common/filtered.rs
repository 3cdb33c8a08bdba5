//! A fine picture made small by the filter of the samples.

use conemarch::base::filter::RADIUS;
use conemarch::picture::frame::Frame;

/// The light of a frame in one pixel.
fn light(frame: &Frame, x: u32, y: u32) -> [f64; 3] {
    let at = (y * frame.size[0] + x) as usize;
    frame.radiance[at].map(f64::from)
}

/// Blackman-Harris, as in its paper.
fn window(x: f64) -> f64 {
    let wave = |n: f64| (std::f64::consts::PI * n * (1.0 + x / RADIUS)).cos();
    match x.abs() < RADIUS {
        true => 0.35875 - 0.48829 * wave(1.0) + 0.14128 * wave(2.0) - 0.01168 * wave(3.0),
        false => 0.0,
    }
}

/// The mean of a picture that is so many times finer about the middle of a pixel of a coarse one, as
/// the filter weights it.
fn filtered(fine: &Frame, times: u32, x: u32, y: u32) -> [f64; 3] {
    let reach = (RADIUS * f64::from(times)).ceil() as i64;
    let middle = |i: u32| i64::from(i * times + times / 2);
    let (mut sum, mut weights) = ([0.0; 3], 0.0);
    for v in middle(y) - reach..middle(y) + reach {
        for u in middle(x) - reach..middle(x) + reach {
            let off = |i: i64, of: u32| ((i - middle(of)) as f64 + 0.5) / f64::from(times);
            let weight = window(off(u, x)) * window(off(v, y));
            let light = light(fine, u as u32, v as u32);
            sum = [0, 1, 2].map(|c| sum[c] + weight * light[c]);
            weights += weight;
        }
    }
    sum.map(|s| s / weights)
}

/// Mean difference of a coarse picture from a filtered fine one, without the border, and its mean
/// size, in light or in what `shown` makes of it.
pub fn apart(coarse: &Frame, fine: &Frame, shown: impl Fn([f64; 3]) -> [f64; 3]) -> [f64; 2] {
    let times = fine.size[0] / coarse.size[0];
    let (mut bias, mut size, mut count) = (0.0, 0.0, 0.0);
    for y in 2..coarse.size[1] - 2 {
        for x in 2..coarse.size[0] - 2 {
            let (a, b) = (
                shown(light(coarse, x, y)),
                shown(filtered(fine, times, x, y)),
            );
            for c in 0..3 {
                bias += a[c] - b[c];
                size += (a[c] - b[c]).abs();
                count += 1.0;
            }
        }
    }
    [bias / count, size / count]
}
