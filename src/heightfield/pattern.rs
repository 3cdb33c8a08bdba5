//! Built-in height maps, made from a pattern's name and a seed, for presets, benchmarks and
//! tests.
//!
//! All are periodic, so that they may wrap, and reach from 0 to 1. The same name, size,
//! seed and power give the same heights on every machine, up to the rounding of its
//! `sin`, `cos` and `exp`.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::base::named::named_enum;
use crate::heightfield::conemap::generate::generator::ShareWatch;

named_enum! {
    /// The patterns.
    pub enum Pattern {
        /// Fractional Brownian motion by spectral synthesis: power falls as a power of the
        /// wave number.
        Fbm = "fbm",
        /// Ridges: where fractional Brownian motion changes sign.
        Ridges = "ridges",
        /// Single samples of 0.4 to 1 over low noise, one in fifty.
        Spikes = "spikes",
        /// Sixteen blocks along each axis, as far as there are samples, high and low.
        Checker = "checker",
        /// A sum of four sines.
        Sine = "sine",
        /// White noise: every sample is independent.
        Noise = "noise",
        /// Rounded stones, closely set: cells of the nearest of scattered points (Worley
        /// 1996), with a rough skin.
        Stones = "stones",
        /// Bricks in eight rows of four, with mortar between them.
        Bricks = "bricks",
    }
}

impl Pattern {
    /// Heights of `size` samples, row by row, each in 0..=1. `power` is the exponent by
    /// which the power of `Fbm` and `Ridges`, and of the skin of `Stones` and `Bricks`, falls
    /// with the wave number: 2.6 for rough terrain, more for smoother.
    pub fn heights(self, size: [u32; 2], seed: u32, power: f64) -> Vec<f32> {
        let made = self.watched(size, seed, power, &mut |_| true);
        made.unwrap_or_default()
    }

    /// As [`Pattern::heights`], for large ones: `None` if `watch` returns `false`, which is told
    /// the share that is done.
    pub fn watched(
        self,
        size: [u32; 2],
        seed: u32,
        power: f64,
        watch: ShareWatch<'_>,
    ) -> Option<Vec<f32>> {
        let [w, h] = size.map(|n| n as usize);
        let (waves, own) = match self {
            Self::Fbm | Self::Ridges => (3 * h + w, 0),
            Self::Stones | Self::Bricks => (3 * h + w, h),
            _ => (0, h),
        };
        let mut making = Making {
            size: [w, h],
            power,
            random: Random::new(seed),
            done: 0,
            rows: waves + own,
            watch,
        };
        let raw: Vec<f64> = match self {
            Self::Fbm => making.spectral()?,
            Self::Ridges => {
                let mut heights = making.spectral()?;
                let mean = heights.iter().sum::<f64>() / heights.len() as f64;
                for z in &mut heights {
                    *z = -(*z - mean).abs();
                }
                heights
            }
            Self::Spikes => making.places(|_, _, random| {
                let (spike, height) = (random.unit() < 0.02, random.unit());
                match spike {
                    true => 0.4 + 0.6 * height,
                    false => 0.15 * height,
                }
            })?,
            Self::Checker => {
                making.places(|x, y, _| ((x * w.min(16) / w + y * h.min(16) / h) % 2) as f64)?
            }
            Self::Sine => making.places(|x, y, _| {
                let [u, v] =
                    [(x, w), (y, h)].map(|(i, n)| std::f64::consts::TAU * i as f64 / n as f64);
                (3.0 * u).sin()
                    + (2.0 * v).cos()
                    + (2.0 * u + 3.0 * v).sin() * 0.5
                    + (5.0 * u - 4.0 * v).cos() * 0.25
            })?,
            Self::Noise => making.places(|_, _, random| random.unit())?,
            Self::Stones => {
                let points = Scattered::new(STONES, &mut making.random);
                making.rough(|place| points.stone(place))?
            }
            Self::Bricks => {
                let mut shade = [0.0; BRICKS[0] * BRICKS[1]];
                shade.fill_with(|| making.random.unit());
                making.rough(|place| brick(place, &shade))?
            }
        };
        Some(stretched(&raw))
    }
}

/// A pattern while it is made, row by row.
struct Making<'a> {
    size: [usize; 2],
    power: f64,
    random: Random,
    /// Rows of work that are done, in all steps, and their number.
    done: usize,
    rows: usize,
    watch: ShareWatch<'a>,
}

impl Making<'_> {
    /// One more row is done; `None` to stop.
    fn next(&mut self) -> Option<()> {
        self.done += 1;
        (self.watch)(self.done as f64 / self.rows as f64).then_some(())
    }

    /// The values of all places, row by row.
    fn places(&mut self, one: impl Fn(usize, usize, &mut Random) -> f64) -> Option<Vec<f64>> {
        let [w, h] = self.size;
        let mut all = Vec::with_capacity(w * h);
        for y in 0..h {
            all.extend((0..w).map(|x| one(x, y, &mut self.random)));
            self.next()?;
        }
        Some(all)
    }

    /// Gaussian waves whose power falls as `k^-power`, k being cycles per map, summed by an
    /// inverse FFT.
    fn spectral(&mut self) -> Option<Vec<f64>> {
        let [w, h] = self.size;
        // The last waves go the other way, with as many cycles.
        let wave = |i: usize, n: usize| i.min(n - i) as f64;
        let mut waves: Vec<Complex<f64>> = Vec::with_capacity(w * h);
        for y in 0..h {
            for x in 0..w {
                let k = wave(x, w).hypot(wave(y, h));
                let amplitude = if k > 0.0 {
                    k.powf(-0.5 * self.power)
                } else {
                    0.0
                };
                let (a, b) = self.random.gauss();
                waves.push(amplitude * Complex::new(a, b));
            }
            self.next()?;
        }
        let mut planner = FftPlanner::new();
        let [along, across] = [w, h].map(|n| planner.plan_fft_inverse(n));
        for row in waves.chunks_mut(w) {
            along.process(row);
            self.next()?;
        }
        let mut turned: Vec<Complex<f64>> = Vec::with_capacity(w * h);
        for x in 0..w {
            turned.extend(waves[x..].iter().step_by(w));
            across.process(&mut turned[x * h..]);
            self.next()?;
        }
        // The real part of waves without symmetry is a field of its own.
        self.places(|x, y, _| turned[x * h + y].re)
    }

    /// Heights by a place of the map in 0..1, with a rough skin whose mean height is 0.
    fn rough(&mut self, one: impl Fn([f64; 2]) -> f64) -> Option<Vec<f64>> {
        let [w, h] = self.size;
        let skin = self.spectral()?;
        let largest = skin.iter().fold(1e-30_f64, |m, s| m.max(s.abs()));
        let one = |x, y| one([x as f64 / w as f64, y as f64 / h as f64]);
        self.places(|x, y, _| one(x, y) + SKIN * skin[y * w + x] / largest)
    }
}

/// Scales heights so that the lowest is 0 and the highest is 1. A constant map becomes 0.
pub(super) fn stretched<T: Copy + Into<f64>>(raw: &[T]) -> Vec<f32> {
    let all = || raw.iter().map(|z| (*z).into());
    let low = all().fold(f64::INFINITY, f64::min);
    let high = all().fold(f64::NEG_INFINITY, f64::max);
    let range = if high > low { high - low } else { 1.0 };
    // The cast may round a share just under 1 up to 1, never beyond.
    all().map(|z| ((z - low) / range) as f32).collect()
}

/// Stones along a side of the map.
const STONES: usize = 9;
/// Bricks in a row, and rows.
const BRICKS: [usize; 2] = [4, 8];
/// Height of a rough skin, of the whole.
const SKIN: f64 = 0.05;

/// From 0 to 1 between two values of x, smoothly.
fn smooth(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A brick wall at a place of the map, in 0..1. Bricks are twice as wide as high.
fn brick([u, v]: [f64; 2], shade: &[f64]) -> f64 {
    let row = (v * BRICKS[1] as f64).floor();
    let along = (u * BRICKS[0] as f64 + 0.5 * (row % 2.0)).rem_euclid(BRICKS[0] as f64);
    let [across, up] = [along.fract(), (v * BRICKS[1] as f64).fract()];
    let edge = (2.0 * across.min(1.0 - across)).min(up.min(1.0 - up));
    let index = row as usize * BRICKS[0] + along.floor() as usize;
    smooth(0.03, 0.16, edge) * (0.7 + 0.3 * shade[index % shade.len()])
}

/// One point in each cell of a grid over the map, and a height for it.
struct Scattered {
    side: usize,
    points: Vec<[f64; 3]>,
}

impl Scattered {
    fn new(side: usize, random: &mut Random) -> Self {
        let mut point = |i: usize| {
            let [x, y] = [(i % side) as f64, (i / side) as f64];
            let [dx, dy, z] = [random.unit(), random.unit(), random.unit()];
            [x + 0.1 + 0.8 * dx, y + 0.1 + 0.8 * dy, z]
        };
        let points = (0..side * side).map(&mut point).collect();
        Self { side, points }
    }

    /// A dome over the nearest point, down to nothing where the next is as near.
    fn stone(&self, place: [f64; 2]) -> f64 {
        let n = self.side as i64;
        let [u, v] = place.map(|p| p * self.side as f64);
        let (mut first, mut second, mut height) = (f64::INFINITY, f64::INFINITY, 0.0);
        for j in -2..=2_i64 {
            for i in -2..=2_i64 {
                let (x, y) = (u.floor() as i64 + i, v.floor() as i64 + j);
                let (cx, cy) = (x.rem_euclid(n), y.rem_euclid(n));
                let [px, py, z] = self.points[(cy * n + cx) as usize];
                // The point of the tile that comes round.
                let at = [px + (x - cx) as f64, py + (y - cy) as f64];
                let d = (at[0] - u).hypot(at[1] - v);
                if d < first {
                    (second, first, height) = (first, d, z);
                } else {
                    second = second.min(d);
                }
            }
        }
        let inside = (second - first) / (second + first);
        (1.0 - (1.0 - inside).powi(3)).sqrt() * (0.6 + 0.4 * height)
    }
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
