//! FLIP: how different two pictures look when they alternate on a screen (Andersson et al.,
//! "FLIP: A Difference Evaluator for Alternating Images", 2020; the form for displays).
//!
//! Colours are blurred as the eye blurs them at a viewing distance and compared in a
//! perceptual space. The difference is raised where edges or points differ. All constants are
//! those of the paper. Beyond the border the outermost pixel repeats.

use glam::DVec3;
use rayon::prelude::*;

use crate::base::srgb::linear;

/// Pixels per degree of visual angle: a screen of 3840 pixels and 0.7 m, seen from 0.7 m.
const PIXELS_PER_DEGREE: f64 = 67.0;

/// The mean FLIP difference of two pictures of one size, from 0 to 1; 0 for equal ones. Their
/// pixels are sRGB colours from 0 to 1, row by row.
pub fn flip(size: [u32; 2], reference: &[DVec3], test: &[DVec3]) -> f64 {
    let size = size.map(|n| n as usize);
    let [one, two] = [reference, test].map(|pixels| PerceivedImage::new(size, pixels));
    let most = hyab(hunt(DVec3::Y), hunt(DVec3::Z)).powf(COLOR_POWER);
    let pairs = (0..one.color.len()).into_par_iter();
    let error = |i: usize| {
        let color = redistribute(hyab(one.color[i], two.color[i]).powf(COLOR_POWER), most);
        let edges = (one.edges[i] - two.edges[i]).abs();
        let points = (one.points[i] - two.points[i]).abs();
        let feature = (edges.max(points) / std::f64::consts::SQRT_2).powf(FEATURE_POWER);
        color.powf(1.0 - feature)
    };
    let errors: Vec<f64> = pairs.map(error).collect();
    // In order, so that the number of threads does not change the sum.
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
}

const COLOR_POWER: f64 = 0.7;
const FEATURE_POWER: f64 = 0.5;
/// Differences up to this share of the largest one are mapped to this part of the range.
const COLOR_KNEE: (f64, f64) = (0.4, 0.95);
/// Width of an edge in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// The contrast sensitivity of each opponent channel, as Gaussians of (weight, width).
const SENSITIVITY: [[(f64, f64); 2]; 3] = [
    [(1.0, 0.0047), (0.0, 1e-5)],
    [(1.0, 0.0053), (0.0, 1e-5)],
    [(34.1, 0.04), (13.5, 0.025)],
];

/// A picture as the eye perceives it.
struct PerceivedImage {
    color: Vec<DVec3>,
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl PerceivedImage {
    fn new(size: [usize; 2], pixels: &[DVec3]) -> Self {
        let opponent: Vec<DVec3> = pixels.iter().map(|c| opponent(linear(*c))).collect();
        let channel = |i: usize| opponent.iter().map(|c| c[i]).collect::<Vec<f64>>();
        let blurred = [0, 1, 2].map(|i| sensed(&channel(i), size, SENSITIVITY[i]));
        let shown = |i: usize| {
            let c = DVec3::from_array(blurred.each_ref().map(|channel| channel[i]));
            hunt(from_opponent(c).clamp(DVec3::ZERO, DVec3::ONE))
        };
        let color = (0..opponent.len()).map(shown).collect();
        let light: Vec<f64> = channel(0).iter().map(|y| (y + 16.0) / 116.0).collect();
        let sd = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let radius = (3.0 * sd).ceil() as i32;
        let bell = |x: f64| (-x * x / (2.0 * sd * sd)).exp();
        let blur = signed(&taps(radius, bell));
        let slope = signed(&taps(radius, |x| -x * bell(x)));
        let bend = signed(&taps(radius, |x| (x * x / (sd * sd) - 1.0) * bell(x)));
        let size_of = |kernel: &[f64]| -> Vec<f64> {
            let x = convolve(&light, size, kernel, &blur);
            let y = convolve(&light, size, &blur, kernel);
            x.iter().zip(&y).map(|(x, y)| x.hypot(*y)).collect()
        };
        Self {
            color,
            edges: size_of(&slope),
            points: size_of(&bend),
        }
    }
}

/// A channel blurred by its contrast sensitivity.
fn sensed(channel: &[f64], size: [usize; 2], gaussians: [(f64, f64); 2]) -> Vec<f64> {
    use std::f64::consts::PI;
    // The radius of the widest Gaussian, as in the paper.
    let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let mut sum = vec![0.0; channel.len()];
    let mut total = 0.0;
    for (weight, width) in gaussians.into_iter().filter(|g| g.0 > 0.0) {
        let scale = PI * PI / (width * PIXELS_PER_DEGREE * PIXELS_PER_DEGREE);
        let kernel = taps(radius, |x| (-scale * x * x).exp());
        let height = weight * (PI / width).sqrt();
        total += height * kernel.iter().sum::<f64>().powi(2);
        let part = convolve(channel, size, &kernel, &kernel);
        for (s, p) in sum.iter_mut().zip(part) {
            *s += height * p;
        }
    }
    sum.iter().map(|s| s / total).collect()
}

fn taps(radius: i32, f: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| f(f64::from(x))).collect()
}

/// Scales a kernel so that its positive taps sum to 1 and its negative ones to -1.
fn signed(kernel: &[f64]) -> Vec<f64> {
    let up: f64 = kernel.iter().filter(|k| **k > 0.0).sum();
    let down: f64 = -kernel.iter().filter(|k| **k < 0.0).sum::<f64>();
    let scale = |k: &f64| if *k > 0.0 { k / up } else { k / down };
    kernel.iter().map(scale).collect()
}

/// Convolves along x and then along y.
fn convolve(image: &[f64], [width, height]: [usize; 2], x: &[f64], y: &[f64]) -> Vec<f64> {
    let radius = x.len() / 2;
    let at = |i: usize, tap: usize, last: usize| (i + tap).saturating_sub(radius).min(last);
    let row = |from: &[f64], i: usize| -> f64 {
        let taps = x.iter().enumerate();
        taps.map(|(tap, k)| k * from[at(i, tap, width - 1)]).sum()
    };
    let rows = image.par_chunks(width);
    let rows = rows.flat_map_iter(|from| (0..width).map(move |i| row(from, i)));
    let rows: Vec<f64> = rows.collect();
    let mut all = vec![0.0; image.len()];
    all.par_chunks_mut(width).enumerate().for_each(|(j, to)| {
        for (tap, k) in y.iter().enumerate() {
            let row = at(j, tap, height - 1) * width;
            for (to, from) in to.iter_mut().zip(&rows[row..row + width]) {
                *to += k * from;
            }
        }
    });
    all
}

fn redistribute(error: f64, most: f64) -> f64 {
    let (knee, part) = (COLOR_KNEE.0 * most, COLOR_KNEE.1);
    if error < knee {
        error * part / knee
    } else {
        part + (error - knee) / (most - knee) * (1.0 - part)
    }
}

/// Euclidean in hue and chroma, absolute in lightness (Abasi et al. 2020).
fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

/// Linear colour to CIELAB, with chroma scaled by lightness (Hunt 1952).
fn hunt(rgb: DVec3) -> DVec3 {
    let f = |t: f64| {
        let d = 6.0_f64 / 29.0;
        match t > d.powi(3) {
            true => t.cbrt(),
            false => t / (3.0 * d * d) + 4.0 / 29.0,
        }
    };
    let n = to_xyz(rgb) / white();
    let (x, y, z) = (f(n.x), f(n.y), f(n.z));
    let l = 116.0 * y - 16.0;
    DVec3::new(l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z))
}

/// Linear colour to the linearised opponent space YCxCz.
fn opponent(rgb: DVec3) -> DVec3 {
    let n = to_xyz(rgb) / white();
    DVec3::new(116.0 * n.y - 16.0, 500.0 * (n.x - n.y), 200.0 * (n.y - n.z))
}

fn from_opponent(c: DVec3) -> DVec3 {
    let y = (c.x + 16.0) / 116.0;
    let n = DVec3::new(y + c.y / 500.0, y, y - c.z / 200.0);
    rgb_matrix().inverse() * (n * white())
}

/// The D65 white: what equal red, green and blue give.
fn white() -> DVec3 {
    to_xyz(DVec3::ONE)
}

fn to_xyz(rgb: DVec3) -> DVec3 {
    rgb_matrix() * rgb
}

/// Linear sRGB to CIE XYZ, by columns.
fn rgb_matrix() -> glam::DMat3 {
    let red = [
        10_135_552.0 / 24_577_794.0,
        871_024.0 / 4_096_299.0,
        79_184.0 / 4_096_299.0,
    ];
    let green = [
        8_788_810.0 / 24_577_794.0,
        8_788_810.0 / 12_288_897.0,
        4_394_405.0 / 36_866_691.0,
    ];
    let blue = [
        4_435_075.0 / 24_577_794.0,
        887_015.0 / 12_288_897.0,
        70_074_185.0 / 73_733_382.0,
    ];
    glam::DMat3::from_cols_array_2d(&[red, green, blue])
}

#[cfg(test)]
mod tests {
    use super::*;

    type Paint = fn(u32, u32) -> [u8; 3];

    fn ramp(x: u32, y: u32) -> [u8; 3] {
        [(x * 5) as u8, (y * 7) as u8, 128]
    }

    fn brighter(x: u32, y: u32) -> [u8; 3] {
        ramp(x, y).map(|c| c.saturating_add(20))
    }

    fn turned(x: u32, y: u32) -> [u8; 3] {
        let [r, g, b] = ramp(x, y);
        [g, b, r]
    }

    fn edge<const AT: u32>(x: u32, _: u32) -> [u8; 3] {
        [[20, 30, 60], [200, 180, 90]][usize::from(x < AT)]
    }

    fn point(x: u32, y: u32) -> [u8; 3] {
        [[60, 120, 200], [255, 0, 255]][usize::from((x, y) == (20, 10))]
    }

    /// Pairs of pictures of 48 x 32 pixels, and the result of the authors' own program
    /// (version 1.2, at 67 pixels per degree).
    const KNOWN: &[(&str, Paint, Paint, f64)] = &[
        ("black and white", |_, _| [0; 3], |_, _| [255; 3], 0.967_399),
        ("a brighter ramp", ramp, brighter, 0.343_887),
        ("other colours", ramp, turned, 0.817_031),
        ("a moved edge", edge::<24>, edge::<26>, 0.128_674),
        ("one pixel", |_, _| point(0, 0), point, 0.003_247),
        (
            "green and blue",
            |_, _| [0, 255, 0],
            |_, _| [0, 0, 255],
            1.0,
        ),
    ];

    #[test]
    fn agrees_with_the_authors_program() {
        for (name, one, two, want) in KNOWN {
            let [one, two] = [one, two].map(|paint| {
                let all = (0..32).flat_map(|y| (0..48).map(move |x| paint(x, y)));
                let all = all.map(|c| DVec3::from_array(c.map(f64::from)) / 255.0);
                all.collect::<Vec<_>>()
            });
            let got = flip([48, 32], &one, &two);
            // The authors' program computes in f32.
            assert!((got - want).abs() < 2e-4, "{name}: {got}, {want}");
            assert_eq!(flip([48, 32], &one, &one), 0.0, "{name}");
        }
    }
}
