//! One estimate in three arithmetics: f32 on the adapter, the same text in f64 on the
//! adapter where it has that, and f64 on the CPU, at points in all distances from the
//! surface.

use conemarch::base::shader::Program;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::formula::{DistanceEstimate, Formula};
use glam::DVec3;

use super::probe::{Numbers, Probe};
use super::programs::in_f64;
use super::random::Random;
use super::setups::{formula_probe, four, narrow};

/// Points in each distance.
const POINTS: usize = 300;

/// A point, and the relative errors of its estimate.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The distance that the point was looked for at, as a power of ten.
    pub power: i32,
    /// Iterations until the orbit escaped.
    pub spent: u32,
    /// Error of f32 in computing: the point is the one that f32 holds.
    pub computed: f64,
    /// Error of f32 in all, the point's rounding included.
    pub in_all: f64,
    /// Error of f64 on the adapter, where it has that.
    pub doubled: Option<f64>,
}

/// Points at 1e-1 to 1e-9 from the surface, by the estimate; with the iterations that a
/// render would do there.
fn points(m: &Mandelbox) -> Vec<(i32, DVec3, u32)> {
    let mut random = Random::new(31);
    let size = m.bounds().half.max_element();
    let mut all = Vec::new();
    for power in 1..=9 {
        let distance = 10.0_f64.powi(-power);
        let most = m.iterations(0.25 * distance);
        let mut found = 0;
        while found < POINTS {
            let (start, axis) = (random.cube(1.2 * size), random.direction());
            let mut t = 0.0;
            for _ in 0..400 {
                let (d, _) = m.estimate(start + t * axis, most);
                if d <= 1.2 * distance {
                    if d > 0.8 * distance {
                        all.push((-power, two_f32(start + t * axis), most));
                        found += 1;
                    }
                    break;
                }
                t += 0.5 * (d - distance);
                if t > 4.0 * size {
                    break;
                }
            }
        }
    }
    all
}

/// The nearest sum of two f32: a point that can be asked about without another rounding.
fn two_f32(p: DVec3) -> DVec3 {
    let high = p.map(narrow);
    high + (p - high).map(narrow)
}

/// A Mandelbox's estimate, asked in f32 or in f64.
pub fn asker(m: &Mandelbox, double: bool) -> Probe {
    let mut all = formula_probe(Formula::Mandelbox(m.clone()), 60);
    if double {
        all.modules = in_f64(&Program::new("probe", all.modules)).modules;
    }
    all
}

/// The three side by side.
pub fn samples(m: &Mandelbox) -> Vec<Sample> {
    let points = points(m);
    let questions: Vec<Numbers> = points
        .iter()
        .map(|(_, p, most)| {
            let low = *p - p.map(narrow);
            [four(*p, f64::from(*most)), four(low, 0.0), [0.0; 4]]
        })
        .collect();
    let ask = |double| asker(m, double).ask(&questions);
    let singles = ask(false);
    let doubles = has_f64().then(|| ask(true));
    let sum = |a: &Numbers| f64::from(a[0][0]) + f64::from(a[0][1]);
    let of = |(i, (power, p, most)): (usize, &(i32, DVec3, u32))| {
        let (wanted, spent) = m.estimate(*p, *most);
        let single = sum(&singles[i]);
        // A point that is rounded to f32 may lie in the set, where the estimate is 0.
        let least = 0.01 * 10.0_f64.powi(*power);
        let error = |got: f64, want: f64| (got - want).abs() / want.abs().max(least);
        Sample {
            power: *power,
            spent,
            computed: error(single, m.estimate(p.map(narrow), *most).0),
            in_all: error(single, wanted),
            doubled: doubles.as_ref().map(|d| error(sum(&d[i]), wanted)),
        }
    };
    points.iter().enumerate().map(of).collect()
}

/// Whether the adapter computes in f64.
pub fn has_f64() -> bool {
    crate::adapter::with(|r| {
        r.device
            .device
            .features()
            .contains(wgpu::Features::SHADER_F64)
    })
}

/// Median and 99 % of some numbers; NaN counts as infinite.
pub fn quantiles(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut all: Vec<f64> = numbers.collect();
    all.iter_mut()
        .filter(|x| x.is_nan())
        .for_each(|x| *x = f64::INFINITY);
    all.sort_by(f64::total_cmp);
    let last = all.len().saturating_sub(1);
    [0.5, 0.99].map(|q| all.get((q * last as f64) as usize).copied().unwrap_or(0.0))
}
