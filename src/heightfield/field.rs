//! Heights by name: made from a formula and a seed, for presets, benchmarks and tests.
//!
//! All are periodic, so that they may wrap, and reach from 0 to 1. The same name, size,
//! seed and power give the same heights on every machine up to the rounding of its
//! `sin`, `cos` and `exp`.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Formulas of height fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Field {
    /// Fractional Brownian motion by spectral synthesis: power falls as a power of the
    /// wave number.
    Fbm,
    /// Ridges: where fractional Brownian motion changes sign.
    Ridges,
    /// Single samples of 0.4 to 1 over low noise, one in fifty.
    Spikes,
    /// Blocks of sixteen to the map, high and low.
    Checker,
    /// A sum of four sines.
    Sine,
    /// White noise: every sample on its own.
    Noise,
}

impl Field {
    /// Every field.
    pub const ALL: [Self; 6] = [
        Self::Fbm,
        Self::Ridges,
        Self::Spikes,
        Self::Checker,
        Self::Sine,
        Self::Noise,
    ];

    /// The word that chooses it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fbm => "fbm",
            Self::Ridges => "ridges",
            Self::Spikes => "spikes",
            Self::Checker => "checker",
            Self::Sine => "sine",
            Self::Noise => "noise",
        }
    }

    /// The field of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.name() == name)
    }

    /// Heights of `size` samples, row by row, each in 0..=1. `power` is the exponent by
    /// which the power of `Fbm` and `Ridges` falls with the wave number: 2.6 for rough
    /// terrain, more for smoother.
    pub fn heights(self, size: [u32; 2], seed: u32, power: f64) -> Vec<f32> {
        let mut random = Random::new(seed);
        let [w, h] = size.map(|n| n as usize);
        let places = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
        let raw: Vec<f64> = match self {
            Self::Fbm => spectral([w, h], power, &mut random),
            Self::Ridges => {
                let mut heights = spectral([w, h], power, &mut random);
                let mean = heights.iter().sum::<f64>() / heights.len() as f64;
                for z in &mut heights {
                    *z = -(*z - mean).abs();
                }
                heights
            }
            Self::Spikes => places
                .map(|_| {
                    let (spike, height) = (random.unit() < 0.02, random.unit());
                    if spike {
                        0.4 + 0.6 * height
                    } else {
                        0.15 * height
                    }
                })
                .collect(),
            Self::Checker => places
                .map(|(x, y)| ((x * 16 / w + y * 16 / h) % 2) as f64)
                .collect(),
            Self::Sine => places
                .map(|(x, y)| {
                    let [u, v] =
                        [(x, w), (y, h)].map(|(i, n)| std::f64::consts::TAU * i as f64 / n as f64);
                    (3.0 * u).sin()
                        + (2.0 * v).cos()
                        + (2.0 * u + 3.0 * v).sin() * 0.5
                        + (5.0 * u - 4.0 * v).cos() * 0.25
                })
                .collect(),
            Self::Noise => places.map(|_| random.unit()).collect(),
        };
        stretched(&raw)
    }
}

/// Brings the lowest to 0 and the highest to 1; a constant field to 0.
fn stretched(raw: &[f64]) -> Vec<f32> {
    let low = raw.iter().copied().fold(f64::INFINITY, f64::min);
    let high = raw.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let range = if high > low { high - low } else { 1.0 };
    raw.iter().map(|z| ((z - low) / range) as f32).collect()
}

/// Gaussian waves whose power falls as `k^-power`, k being cycles per map, summed by an
/// inverse FFT.
fn spectral([w, h]: [usize; 2], power: f64, random: &mut Random) -> Vec<f64> {
    let wave = |i: usize, n: usize| {
        if 2 * i > n {
            i as f64 - n as f64
        } else {
            i as f64
        }
    };
    let mut waves: Vec<Complex<f64>> = Vec::with_capacity(w * h);
    for y in 0..h {
        for x in 0..w {
            let k = wave(x, w).hypot(wave(y, h));
            let amplitude = if k > 0.0 { k.powf(-0.5 * power) } else { 0.0 };
            let (a, b) = random.gauss();
            waves.push(amplitude * Complex::new(a, b));
        }
    }
    let mut planner = FftPlanner::new();
    let rows = planner.plan_fft_inverse(w);
    let columns = planner.plan_fft_inverse(h);
    rows.process(&mut waves);
    let mut turned: Vec<Complex<f64>> = (0..w)
        .flat_map(|x| (0..h).map(move |y| (x, y)))
        .map(|(x, y)| waves[y * w + x])
        .collect();
    columns.process(&mut turned);
    // The real part of waves without symmetry is a field of its own.
    let places = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
    places.map(|(x, y)| turned[x * h + y].re).collect()
}

/// A small generator of random numbers (PCG-XSH-RR 64/32; O'Neill 2014).
struct Random(u64);

impl Random {
    fn new(seed: u32) -> Self {
        let mut random = Self(u64::from(seed).wrapping_add(0x853c_49e6_748f_ea9b));
        random.next();
        random
    }

    fn next(&mut self) -> u32 {
        let old = self.0;
        self.0 = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let mixed = (((old >> 18) ^ old) >> 27) as u32;
        mixed.rotate_right((old >> 59) as u32)
    }

    /// In 0..1.
    fn unit(&mut self) -> f64 {
        f64::from(self.next()) / 4_294_967_296.0
    }

    /// Two independent normal numbers (Box and Muller 1958).
    fn gauss(&mut self) -> (f64, f64) {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        (radius * cos, radius * sin)
    }
}
