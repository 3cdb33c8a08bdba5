//! The balls of the Mandelbox in f64: those that are proven hold no point of the set, those that
//! rays step by hold one only as far as docs/method.md says.

use conemarch::formula::DistanceEstimate;
use conemarch::formula::mandelbox::{Estimate, Mandelbox};
use glam::DVec3;

use crate::common::climbs::{
    Climb, climb, largest, of_the_set, settings, start, start_in_julia_mode,
};
use crate::common::random::Random;

/// Iterations after which an estimate in f64 no longer changes.
const MANY: u32 = 120;
/// What rounding adds to a ball in f64, near points of the set that are themselves rounded.
const ROUNDED: f64 = 1.0 + 1e-6;

/// The largest overstep of so many climbs. `radius` is told a centre and its distance from the set.
fn search(m: &Mandelbox, count: usize, radius: impl Fn(DVec3, f64) -> f64) -> Climb {
    let random = &mut Random::new(77);
    let climbs = start(m, count, random);
    search_from(climbs, random, radius)
}

fn search_from(
    mut climbs: Vec<Climb>,
    random: &mut Random,
    radius: impl Fn(DVec3, f64) -> f64,
) -> Climb {
    climb(&mut climbs, 40, random, |tried| {
        tried.iter().map(|(p, off)| radius(*p, *off)).collect()
    });
    largest(&climbs)
}

#[test]
fn proven_balls_are_empty() {
    for m in settings() {
        let evaluator = m.evaluator();
        for trial in [0.7, 1.0, 1.5] {
            let worst = search(&m, 3400, |p, off| {
                evaluator.ball(p, MANY, trial * off).radius
            });
            assert!(worst.ratio < ROUNDED, "{m:?}, trial {trial}: {worst:?}");
            // The search comes close, or it would prove nothing.
            assert!(worst.ratio > 0.69, "{m:?}, trial {trial}: {worst:?}");
        }
        // Near a hit the last radius may be far larger.
        for trial in [3.0, 10.0, 100.0] {
            let worst = search(&m, 1000, |p, off| {
                evaluator.ball(p, MANY, trial * off).radius
            });
            assert!(worst.ratio < ROUNDED, "{m:?}, trial {trial}: {worst:?}");
        }
    }
}

#[test]
fn proven_balls_are_empty_in_julia_mode_and_with_a_rotation() {
    for mut m in settings() {
        m.julia_constant = m.fold_limit * DVec3::new(0.7, -0.4, 1.1);
        m.julia = true;
        let evaluator = m.evaluator();
        for (trial, count) in [(1.2, 2000), (10.0, 500)] {
            let ball = |p, off: f64| evaluator.ball(p, MANY, trial * off).radius;
            let worst = search(&m, count, ball);
            assert!(worst.ratio < ROUNDED, "{m:?}, trial {trial}: {worst:?}");
        }
        m.julia = false;
        m.rotation = DVec3::new(12.0, -8.0, 25.0);
        let evaluator = m.evaluator();
        for (trial, count) in [(1.0, 1000), (10.0, 500)] {
            let ball = |p, off: f64| evaluator.ball(p, MANY, trial * off).radius;
            let worst = search(&m, count, ball);
            assert!(worst.ratio < ROUNDED, "{m:?}, trial {trial}: {worst:?}");
        }
    }
}

/// A ball about a point outside the fixed sphere, which reaches into it: the fold spreads that part.
#[test]
fn a_ball_pulled_back_across_the_fixed_sphere_is_empty() {
    let mut m = Mandelbox {
        scale: 5.292_22,
        fold_limit: 7.011_92,
        min_radius: 0.063_048_8,
        fixed_radius: 1.0,
        julia: true,
        julia_constant: DVec3::new(7.710_814_66, 107.135_507, -42.349_377_6),
        ..Mandelbox::default()
    };
    let p = DVec3::new(14.422_873_290_2, 16.711_312_984_9, 0.678_272_732_855);
    let q = DVec3::new(14.032_543_322_1, 14.082_448_537_9, 0.014_791_452_701);
    let (evaluator, off) = (m.evaluator(), p.distance(q));
    // It is of the set, but for the digits that are written here.
    let value = evaluator.value(q, MANY).0;
    assert!(value < 1e-4, "{value}");
    let ball = evaluator.ball(p, MANY, 1.33 * off).radius;
    assert!(ball > 0.5 * off && ball < off, "{}", ball / off);
    // Small inner radii, and constants far out.
    let random = &mut Random::new(8);
    let mut closest = 0.0_f64;
    for i in 0..60 {
        m.scale = random.between(1.5, 6.0) * if i % 2 == 0 { 1.0 } else { -1.0 };
        m.fold_limit = random.between(0.5, 8.0);
        m.min_radius = 10.0_f64.powf(random.between(-2.0, -0.2));
        m.julia_constant = m.fold_limit * m.scale.abs() * random.cube(3.0);
        let evaluator = m.evaluator();
        for trial in [1.1, 1.5] {
            let ball = |p, off: f64| evaluator.ball(p, MANY, trial * off).radius;
            let climbs = start_in_julia_mode(&m, 400, random);
            let worst = search_from(climbs, random, ball);
            assert!(worst.ratio < ROUNDED, "{m:?}, trial {trial}: {worst:?}");
            closest = closest.max(worst.ratio);
        }
    }
    assert!(closest > 0.99, "{closest}");
}

/// A fold with extreme radii spreads a ball over all numbers. No part of it is proven then.
#[test]
fn a_ball_that_spreads_beyond_all_numbers_proves_nothing() {
    let m = Mandelbox {
        scale: 2.0,
        fold_limit: 1.0,
        min_radius: 1e-6,
        fixed_radius: 1e3,
        ..Mandelbox::default()
    };
    // The origin is of the set.
    let ball = m.evaluator().ball(DVec3::new(1e-7, 0.0, 0.0), MANY, 1.0);
    assert!(ball.radius < 1e-7, "{ball:?}");
}

/// Steps of rays follow the derivative at their start, and a ball fold's factor varies over a step.
/// Where it does not vary, they are exact.
#[test]
fn steps_are_empty_where_ball_folds_do_not_invert() {
    let mut closest = 0.0_f64;
    for mut m in settings() {
        m.min_radius = m.fixed_radius;
        let evaluator = m.evaluator();
        let worst = search(&m, 2000, |p, _| evaluator.step(p, MANY, 0.0).radius);
        assert!(worst.ratio < ROUNDED, "{m:?}: {worst:?}");
        closest = closest.max(worst.ratio);
    }
    assert!(closest > 0.9, "{closest}");
}

/// Rotations by little and by much.
const ROTATIONS: [DVec3; 3] = [
    DVec3::new(12.0, -8.0, 25.0),
    DVec3::new(1.0, 0.0, 0.0),
    DVec3::new(0.0, 0.0, 45.0),
];

/// The table of docs/method.md, 3.
#[test]
fn steps_are_too_long_by_as_much_as_is_said() {
    const PLAIN: [f64; 10] = [1.1, 1.25, 1.15, 1.2, 1.2, 1.1, 1.15, 1.2, 1.01, 1.05];
    const ROTATED: [f64; 10] = [1.0, 1.2, 1.2, 1.1, 1.2, 1.2, 1.1, 1.2, 1.05, 1.1];
    // With constants of 0.3 to 10 L |s|.
    const LARGE: [f64; 10] = [1.0, 1.75, 1.25, 1.8, 2.8, 1.65, 1.55, 2.45, 1.0, 0.9];
    const JULIA: [f64; 10] = [1.1, 1.1, 1.1, 1.1, 1.1, 1.0, 1.0, 1.0, 1.1, 1.0];
    let mut untrue = Vec::new();
    for (i, mut m) in settings().into_iter().enumerate() {
        let scale = m.scale;
        let worst = |m: &Mandelbox| {
            let evaluator = m.evaluator();
            search(m, 3000, |p, _| evaluator.step(p, MANY, 0.0).radius).ratio
        };
        // No step is longer than is said, and the search comes near it.
        let mut check = |what: &str, found: f64, said: f64| {
            let told = format!("scale {scale}, {what}: {found:.3}, said {said}");
            println!("{told}");
            if found >= said * ROUNDED || found < 0.7 * said {
                untrue.push(told);
            }
        };
        check("plain", worst(&m), PLAIN[i]);
        let rotated = ROTATIONS.map(|rotation| {
            worst(&Mandelbox {
                rotation,
                ..m.clone()
            })
        });
        check(
            "rotated",
            rotated.into_iter().fold(0.0, f64::max),
            ROTATED[i],
        );
        m.julia_constant = m.fold_limit * DVec3::new(0.7, -0.4, 1.1);
        m.julia = true;
        check("Julia", worst(&m), JULIA[i]);
        let random = &mut Random::new(78);
        let mut large = 0.0_f64;
        for _ in 0..30 {
            let length = m.fold_limit * m.scale.abs() * 10.0_f64.powf(random.between(-0.5, 1.0));
            m.julia_constant = length * random.direction();
            let evaluator = m.evaluator();
            let climbs = start_in_julia_mode(&m, 400, random);
            let found = search_from(climbs, random, |p, _| evaluator.step(p, MANY, 0.0).radius);
            large = large.max(found.ratio);
        }
        check("large constants", large, LARGE[i]);
    }
    assert!(untrue.is_empty(), "{untrue:#?}");
}

/// With a rotation, cones go by steps over a constant that is larger than any overstep.
#[test]
fn cones_are_empty_with_a_rotation() {
    let mut closest = 0.0_f64;
    for mut m in settings() {
        for rotation in ROTATIONS {
            m.rotation = rotation;
            let evaluator = m.evaluator();
            let worst = search(&m, 3000, |p, off| evaluator.cone(p, MANY, 1.5 * off).radius);
            assert!(worst.ratio < 1.0, "{m:?}: {worst:?}");
            closest = closest.max(worst.ratio);
        }
    }
    assert!(closest > 0.8, "{closest}");
}

/// A point whose step passes a point of the set, found by a climb.
#[test]
fn a_step_that_is_too_long_is_known() {
    let m = Mandelbox::default();
    let p = DVec3::new(-2.275_275_5, 5.925_384_4, 4.129_797_5);
    let q = DVec3::new(-2.263_832_1, 5.921_871_0, 4.129_756_0);
    let (evaluator, off) = (m.evaluator(), p.distance(q));
    assert!((off - 0.011_97).abs() < 1e-5);
    let step = evaluator.step(p, MANY, 0.0).radius;
    assert!((step / off - 1.13).abs() < 0.01, "{}", step / off);
    let ball = evaluator.ball(p, MANY, off).radius;
    assert!(ball > 0.3 * off && ball < off, "{}", ball / off);
}

/// At scale -3 the scalar estimate exceeds the distance by more than 1.1, and a step stays within.
#[test]
fn an_estimate_that_is_too_large_is_known() {
    let m = Mandelbox {
        scale: -3.0,
        ..Mandelbox::default()
    };
    assert_eq!(
        (m.fold_limit, m.min_radius, m.fixed_radius),
        (1.0, 0.5, 1.0)
    );
    let scalar = Mandelbox {
        estimate: Estimate::Scalar,
        ..m.clone()
    };
    let p = DVec3::new(0.7587, -0.0392, 1.9074);
    let q = DVec3::new(0.756_660_022, -0.039_084_038, 1.905_269_723);
    let off = p.distance(q);
    // It is of the set, but for the digits that are written here.
    let value = scalar.evaluator().value(q, MANY).0;
    assert!(value < 1e-6 * off, "{value}");
    let value = scalar.evaluator().value(p, MANY).0;
    assert!((value / off - 1.213).abs() < 0.002, "{}", value / off);
    assert!(value < scalar.lipschitz() * off, "{}", scalar.lipschitz());
    let step = m.evaluator().step(p, MANY, 0.0).radius;
    assert!(step > 0.9 * off && step < off, "{}", step / off);
}

/// |z|/w far out, with the Jacobian's norm after the first linear iterations in place of w: what
/// the estimate of an escaped orbit tends to. Written without the code under test.
fn converged(m: &Mandelbox, p: DVec3, follow: u32) -> f64 {
    let c = if m.julia { m.julia_constant } else { p };
    let gain = f64::from(u8::from(!m.julia));
    let (mut z, mut w, mut diagonal) = (p, 1.0, DVec3::ONE);
    let mut linear = true;
    for n in 0..400 {
        if z.length() > 1e12 * m.bounds().half.length() {
            break;
        }
        let mut d = DVec3::ONE;
        for i in 0..3 {
            if z[i].abs() > m.fold_limit {
                z[i] = 2.0 * m.fold_limit * z[i].signum() - z[i];
                d[i] = -1.0;
            }
        }
        let l = z.length();
        linear &= n < follow && !(l > m.min_radius && l < m.fixed_radius);
        let factor = (m.fixed_radius / l.clamp(m.min_radius, m.fixed_radius)).powi(2) * m.scale;
        diagonal = factor * d * diagonal + gain;
        w = match linear {
            true => diagonal.abs().max_element(),
            false => factor.abs() * w + gain,
        };
        z = factor * z + c;
    }
    z.length() / w
}

#[test]
fn an_estimate_is_the_limit_of_its_orbit_or_a_little_less() {
    let random = &mut Random::new(5);
    for mut m in settings() {
        for julia in [false, true] {
            m.julia = julia;
            m.julia_constant = m.fold_limit * DVec3::new(0.7, -0.4, 1.1);
            let follow = if m.scale > 0.0 && !julia { 3 } else { 0 };
            let evaluator = m.evaluator();
            for _ in 0..4000 {
                let p = m.bounds().half * random.cube(1.0);
                let limit = converged(&m, p, follow);
                let (value, _) = evaluator.value(p, 400);
                let rounding = 1e-12 * limit.max(m.bounds().half.x);
                assert!(value < limit + rounding, "{m:?} {p}: {value} {limit}");
                assert!(
                    value > 0.85 * limit - rounding,
                    "{m:?} {p}: {value} {limit}"
                );
            }
        }
    }
}

/// Before an orbit of Julia mode has escaped, a large coordinate is no proof that it will.
#[test]
fn an_estimate_never_exceeds_the_limit_whatever_the_iterations() {
    let random = &mut Random::new(6);
    for mut m in settings() {
        m.julia = true;
        m.julia_constant = m.fold_limit * random.cube(6.0);
        let evaluator = m.evaluator();
        for _ in 0..4000 {
            let p = m.bounds().half * random.cube(1.0);
            let limit = converged(&m, p, 0);
            for most in 1..6 {
                let (value, _) = evaluator.value(p, most);
                let rounding = 1e-12 * limit.max(m.bounds().half.x);
                assert!(
                    value < limit + rounding,
                    "{m:?} {p}, {most}: {value} {limit}"
                );
            }
        }
    }
}

/// Steps are at least those of the growth factor for all directions: no part of the chain may get
/// lost.
#[test]
fn steps_are_not_shorter_than_those_of_the_scalar_estimate() {
    let random = &mut Random::new(7);
    for m in settings() {
        let scalar = Mandelbox {
            estimate: Estimate::Scalar,
            ..m.clone()
        };
        let points = of_the_set(&m, 300, random);
        let [tight, scalar] = [&m, &scalar].map(|m| m.evaluator());
        for (set, _) in points {
            let off = m.fold_limit * 10.0_f64.powf(random.between(-4.0, 0.0));
            let p = set + off * random.direction();
            let (step, old) = (tight.step(p, MANY, 0.0).radius, scalar.value(p, MANY).0);
            let least = 0.9 * old / m.lipschitz() - 1e-9;
            assert!(step > least, "{m:?} {p}: {step} {old}");
        }
    }
}
