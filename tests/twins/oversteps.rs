//! The balls of the Mandelbox in f32: see `tests/solids/oversteps.rs`.

use conemarch::formula::mandelbox::Mandelbox;
use conemarch::formula::{DistanceEstimate, Formula};
use glam::DVec3;

use super::common::climbs::{Climb, climb, largest, settings, start};
use super::common::probe::Numbers;
use super::common::random::Random;
use super::common::setups::{formula_probe, four, narrow};

/// Iterations after which an estimate in f32 no longer changes.
const MANY: u32 = 60;
/// The rounding of a ball's radius, as a share of the bounds (docs/method.md, 6).
const ROUNDED: f64 = 1e-6;

/// The largest overstep of so many climbs in f32, where a ball of `trial` times the distance is tried.
/// The answer of the probe holds the radius at `place`.
fn search(m: &Mandelbox, (count, trial): (usize, f64), place: usize) -> Climb {
    let random = &mut Random::new(78);
    let mut climbs = start(m, count, random);
    let half = m.bounds().half.x;
    let probe = formula_probe(Formula::Mandelbox(m.clone()), MANY);
    climb(&mut climbs, 12, random, |tried| {
        let question = |(p, off): &(DVec3, f64)| -> Numbers {
            let tried = four(DVec3::new(0.0, trial * off, 0.0), 0.0);
            [four(*p, f64::from(MANY)), [0.0; 4], tried]
        };
        let questions: Vec<Numbers> = tried.iter().map(question).collect();
        let radius = |(a, (p, off)): (Numbers, &(DVec3, f64))| {
            // The point that was asked about is another one.
            let moved = p.distance(p.map(narrow));
            let radius = f64::from(a[2][place]) - moved - ROUNDED * half;
            if radius.is_nan() {
                f64::INFINITY * off
            } else {
                radius
            }
        };
        let answers = probe.ask(&questions).into_iter();
        answers.zip(tried).map(radius).collect()
    });
    largest(&climbs)
}

#[test]
fn proven_balls_are_empty_in_f32() {
    // Of both signs, and of small and large radii.
    for m in [2, 6, 7, 8].map(|i| settings().swap_remove(i)) {
        let worst = search(&m, (25_000, 1.2), 1);
        assert!(worst.ratio < 1.0, "{m:?}: {worst:?}");
        assert!(worst.ratio > 0.9, "{m:?}: {worst:?}");
        // Near a hit the last radius may be far larger.
        for trial in [3.0, 30.0] {
            let worst = search(&m, (2500, trial), 1);
            assert!(worst.ratio < 1.0, "{m:?}, trial {trial}: {worst:?}");
        }
    }
}

#[test]
fn proven_balls_are_empty_in_f32_in_julia_mode_and_with_a_rotation() {
    for mut m in [2, 6, 7, 8].map(|i| settings().swap_remove(i)) {
        m.julia_constant = m.fold_limit * DVec3::new(0.7, -0.4, 1.1);
        m.julia = true;
        let worst = search(&m, (12_500, 1.2), 1);
        assert!(worst.ratio < 1.0, "{m:?}: {worst:?}");
        assert!(worst.ratio > 0.5, "{m:?}: {worst:?}");
        m.julia = false;
        m.rotation = DVec3::new(12.0, -8.0, 25.0);
        let worst = search(&m, (12_500, 1.2), 1);
        assert!(worst.ratio < 1.0, "{m:?}: {worst:?}");
        assert!(worst.ratio > 0.1, "{m:?}: {worst:?}");
    }
}

/// Those boxes have these bounds in the table of docs/method.md, 3.
#[test]
fn steps_in_f32_are_too_long_by_as_much_as_is_said() {
    for (i, said) in [(2, 1.15), (6, 1.15), (7, 1.2), (8, 1.01)] {
        let m = settings().swap_remove(i);
        let worst = search(&m, (12_000, 1.2), 0);
        assert!(worst.ratio < said, "{m:?}: {worst:?}");
        assert!(worst.ratio > 0.7 * said, "{m:?}: {worst:?}");
    }
}
