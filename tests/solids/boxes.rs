//! The Mandelbox: its estimate against the converged value, its bounds, its iteration
//! rule, and rotations.

use conemarch::formula::DistanceEstimate;
use conemarch::formula::mandelbox::{Estimate, Mandelbox};
use conemarch::formula::rotation::Rotation;
use glam::{DMat3, DVec3};

use super::common::plans::mandelbox;
use super::common::random::Random;

/// Iterations after which nothing is left to converge.
const MANY: u32 = 300;

/// A random Mandelbox: any scale, radii and fold limit, rotated or not, Julia or not.
fn random_box(random: &mut Random) -> Mandelbox {
    let size = random.between(1.2, 3.5);
    let fixed = random.between(0.3, 2.0);
    let rotated = f64::from(u8::from(random.unit() < 0.4));
    Mandelbox {
        scale: if random.unit() < 0.5 { size } else { -size },
        min_radius: fixed * random.between(0.1, 1.0),
        fixed_radius: fixed,
        fold_limit: random.between(0.3, 2.0),
        rotation: rotated * random.cube(180.0),
        julia: random.unit() < 0.3,
        julia_constant: random.cube(2.0),
        ..Mandelbox::default()
    }
}

/// A point in or about the bounds.
fn random_point(m: &Mandelbox, random: &mut Random) -> DVec3 {
    let bounds = m.bounds();
    random.cube(1.1) * bounds.half.min(DVec3::splat(bounds.radius))
}

/// The orbit once more, by its definition: `|z| / w` when the point has escaped beyond
/// all doubt, 0 if it does not.
fn converged(m: &Mandelbox, p: DVec3) -> f64 {
    let [x, y, z] = m.rotation.to_array().map(f64::to_radians);
    let turn = DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
    let c = if m.julia { m.julia_constant } else { p };
    let fold = |x: f64| 2.0 * x.clamp(-m.fold_limit, m.fold_limit) - x;
    let (mut z, mut w) = (p, 1.0);
    for _ in 0..1000 {
        // Past this the quotient gains nothing that f64 could hold.
        if z.length() > 1e15 {
            return z.length() / w;
        }
        let b = z.map(fold);
        let r = b.length();
        let factor = (m.fixed_radius / r.clamp(m.min_radius, m.fixed_radius)).powi(2);
        z = m.scale * factor * (turn * b) + c;
        w = m.scale.abs() * factor * w + if m.julia { 0.0 } else { 1.0 };
    }
    0.0
}

#[test]
fn the_estimate_grows_with_iterations_and_never_passes_the_converged_value() {
    let random = &mut Random::new(12);
    let mut escaped = 0;
    for _ in 0..3000 {
        let mut m = random_box(random);
        let p = random_point(&m, random);
        let tight = m.evaluator();
        m.estimate = Estimate::Scalar;
        let end = converged(&m, p);
        escaped += u32::from(end > 0.0);
        let noise = 1e-9 * (1.0 + end);
        let mut last = f64::NEG_INFINITY;
        for n in 0..40 {
            let (d, spent) = m.estimate(p, n);
            assert!(spent <= n);
            assert!(d >= last - noise, "{d} after {last} at {n}, {m:?} {p}");
            assert!(d <= end + noise, "{d} above {end} at {n}, {m:?} {p}");
            last = d;
        }
        // The sharper one is never lower.
        let mut last = f64::NEG_INFINITY;
        for n in 3..40 {
            let (d, _) = tight.value(p, n);
            assert!(d >= last - noise, "{d} after {last} at {n}, {m:?} {p}");
            last = d;
        }
        // It comes near: where it stops for the escape, within a tenth. (Orbits that
        // escape late magnify rounding until two computations of them differ.)
        let (d, _) = m.estimate(p, MANY);
        if end > 1e-6 {
            assert!(d > 0.85 * end, "{d} of {end}, {m:?} {p}");
        }
    }
    assert!(escaped > 1000, "only {escaped} points escape");
}

#[test]
fn the_classic_estimate_fails_where_the_proven_one_holds() {
    let random = &mut Random::new(13);
    let above = (0..3000).filter(|_| {
        let m = Mandelbox {
            estimate: Estimate::Classic,
            ..random_box(random)
        };
        let p = random_point(&m, random);
        let end = converged(&m, p);
        m.estimate(p, 12).0 > end + 1e-9 * (1.0 + end)
    });
    let above = above.count();
    assert!(above > 30, "only {above}");
}

#[test]
fn nothing_lies_outside_the_bounds() {
    let random = &mut Random::new(14);
    for _ in 0..4000 {
        let m = random_box(random);
        let bounds = m.bounds();
        // On the surface of the box and of the ball, and a little beyond.
        let mut q = random.cube(1.0);
        if random.unit() < 0.3 {
            q = q.signum();
        }
        let face = q / q.abs().max_element() * bounds.half;
        let on = face.clamp_length_max(bounds.radius);
        let p = bounds.centre + on * random.between(1.001, 1.3);
        assert!(bounds.distance(p) > 0.0);
        let (d, _) = m.estimate(p, MANY);
        assert!(d > 0.0, "{d} at {p}, {m:?}");
    }
    // Tighter bounds would not do: the corners belong to the set.
    for scale in [2.0, 3.0, -1.5, -2.0] {
        let m = mandelbox(scale);
        assert!(m.estimate(m.bounds().half, MANY).0 <= 0.0, "scale {scale}");
    }
}

/// Points whose estimate still grows by more than `eps` after so many iterations.
fn unfinished(eps: f64, count: impl Fn(&Mandelbox) -> u32) -> usize {
    let random = &mut Random::new(15);
    let unfinished = (0..3000).filter(|_| {
        let m = random_box(random);
        let p = random_point(&m, random);
        let n = count(&m);
        // Of two hits it does not matter how deep they are.
        let [now, later] = [n, n + 20].map(|n| m.estimate(p, n).0.max(0.0));
        later - now > eps
    });
    unfinished.count()
}

#[test]
fn after_the_iterations_of_the_rule_little_is_left() {
    for eps in [1e-1, 1e-2, 1e-4, 1e-6] {
        assert_eq!(unfinished(eps, |m| m.iterations(eps)), 0, "at {eps}");
    }
    // A third of them would not do.
    assert!(unfinished(1e-4, |m| m.iterations(1e-4) / 3) > 0);
    // A finer footprint never asks for fewer.
    let m = Mandelbox::default();
    assert!(m.iterations(1e-6) > m.iterations(1e-4));
}

#[test]
fn a_rotation_is_one_and_whole_turns_are_none() {
    for none in [[0.0; 3], [360.0; 3], [-360.0, 0.0, 720.0]].map(DVec3::from) {
        assert_eq!(Rotation::new(none), None);
    }
    let quarter = Rotation::new(DVec3::new(90.0, 0.0, 0.0)).unwrap();
    assert!(quarter.rotate(DVec3::Y).distance(DVec3::Z) < 1e-12);
    // About x first, about z last.
    let two = Rotation::new(DVec3::new(90.0, 0.0, 90.0)).unwrap();
    assert!(two.rotate(DVec3::Y).distance(DVec3::Z) < 1e-12);
    assert!(two.rotate(DVec3::X).distance(DVec3::Y) < 1e-12);
    let random = &mut Random::new(16);
    for _ in 0..1000 {
        let rotation = Rotation::new(random.cube(360.0)).unwrap();
        let (u, v) = (random.direction(), random.direction());
        let (ru, rv) = (rotation.rotate(u), rotation.rotate(v));
        assert!((ru.dot(rv) - u.dot(v)).abs() < 1e-12);
        assert!(ru.cross(rv).distance(rotation.rotate(u.cross(v))) < 1e-12);
    }
}
