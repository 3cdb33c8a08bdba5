//! Scenes in f64 against closed forms: solids against their equations, empty balls and
//! proven fronts against the first meeting of rays, the cones of the view against the
//! rays of its pixels, and the Mandelbox against what is proven of it. Needs no adapter.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

mod boxes;
#[path = "../common"]
#[allow(dead_code, reason = "other crates use the rest")]
mod common {
    pub mod climbs;
    pub mod cones;
    pub mod exact;
    pub mod plans;
    pub mod random;
}
mod cones;
mod lanes;
mod oversteps;
mod sights;

use common::cones::{claimed, cone};
use common::exact::{Exact, balls, distance, first_hit};
use common::random::Random;
use conemarch::base::cone::ConeRule;
use conemarch::base::outcome::{Counts, State};
use conemarch::base::view::{Beam, footprint};
use conemarch::formula::balls::Balls;
use conemarch::formula::{Bounds, Formula};
use conemarch::pass::trace::trace;
use conemarch::scene::distance::Distance;
use conemarch::scene::slab::{Slab, SlabSettings};
use conemarch::scene::stepping::{Relaxation, Stepping};
use conemarch::scene::{Hit, Solid};
use cones::{beyond, sampled_anywhere};
use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// As many cases, the same in every run.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(20),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn stepping(rule: ConeRule) -> Stepping {
    Stepping {
        detail: 1e-3,
        shell: 0.45,
        relaxation: Relaxation::Auto,
        stride: 1.0,
        rule,
        clip: true,
        proven: false,
    }
}

/// Balls of some sizes seen from an eye, and the same in closed form.
fn balls_scene(size: DVec3, eye: DVec3, stepping: Stepping) -> (Distance, Vec<Exact>) {
    let shape = Formula::Balls(Balls {
        rod_radius: size.x,
        box_size: size.y,
        ball_radius: size.z,
    });
    let scene = Distance::new(shape, 1, eye, stepping);
    (scene, balls(size.x, size.y, size.z))
}

fn slab_scene(normal: DVec3, size: DVec3, eye: DVec3, rule: ConeRule) -> (Slab, Vec<Exact>) {
    let shape = SlabSettings {
        normal,
        half: size.x,
        radius: size.y,
    };
    let exact = Exact::Disc(normal.normalize(), size.x, size.y);
    (Slab::new(&shape, eye, rule), vec![exact])
}

fn vector(half: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-half..half).prop_map(DVec3::from_array)
}

/// A vector away from zero.
fn normal() -> impl Strategy<Value = DVec3> {
    vector(1.0).prop_filter("a direction", |v| v.length() > 0.1)
}

/// Rod radius, half edge and ball radius within what presets may say.
fn sizes() -> impl Strategy<Value = DVec3> {
    (0.001..0.5, 0.01..1.2, 0.01..2.5).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

/// Half thickness and radius of a slab; the third is free.
fn slab_sizes() -> impl Strategy<Value = DVec3> {
    (0.01..1.0, 0.1..6.0, 0.0..1.0).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

proptest! {
    #![proptest_config(cases(1000))]

    #[test]
    fn balls_are_as_far_as_their_equations_say(size in sizes(), p in vector(4.0)) {
        let eye = DVec3::new(0.5, -4.0, 1.0);
        let (scene, exact) = balls_scene(size, eye, stepping(ConeRule::Exact));
        let want = distance(&exact, p);
        let (got, spent) = scene.formula.estimate(p, 7);
        prop_assert!((got - want).abs() < 1e-12, "{got} {want}");
        prop_assert_eq!(spent, 1);
        let clear = scene.clearance(p - eye);
        prop_assert!((clear - want.max(0.0)).abs() < 1e-12, "{clear} {want}");
        // The bounds hold everything, however large it is made.
        let bounds = scene.formula.bounds();
        prop_assert!(want > 0.0 || bounds.distance(p) == 0.0);
        prop_assert!(want.max(0.0) >= bounds.distance(p) - 1e-12);
    }

    #[test]
    fn a_slab_is_as_far_as_its_equation_says(
        normal in normal(), size in slab_sizes(), p in vector(8.0), eye in vector(9.0)
    ) {
        let (scene, exact) = slab_scene(normal, size, eye, ConeRule::Exact);
        let want = distance(&exact, p).max(0.0);
        prop_assert!((scene.clearance(p - eye) - want).abs() < 1e-11);
        prop_assert!(want > 0.0 || p.distance(eye) <= scene.bounds_far());
    }

    #[test]
    fn bounds_know_their_nearest_and_farthest_point(
        centre in vector(3.0), half in vector(2.0), radius in 0.2..3.0,
        p in vector(9.0), direction in vector(1.0)
    ) {
        let bounds = Bounds { centre, half: half.abs(), radius };
        // Points of the region: a box's cut by a ball.
        let inside = (2.0 * direction * half.abs()).clamp(-half.abs(), half.abs());
        let inside = centre + inside.clamp_length_max(radius);
        prop_assert!(bounds.distance(inside) < 1e-12);
        prop_assert!(bounds.distance(p) <= p.distance(inside) + 1e-12);
        prop_assert!(bounds.farthest(p) >= p.distance(inside) - 1e-12);
        // Of a box with the ball about its corners both are exact.
        let cube = Bounds { radius: half.length(), ..bounds };
        let nearest = (p - centre).clamp(-half.abs(), half.abs()) + centre;
        prop_assert!((cube.distance(p) - p.distance(nearest)).abs() < 1e-9);
        let far = centre - half.abs() * (p - centre).signum();
        prop_assert!((cube.farthest(p) - p.distance(far)).abs() < 1e-9);
    }

    #[test]
    fn no_ray_meets_the_balls_before_the_front(
        size in sizes(), eye in vector(4.0), seed in any::<u64>(), steps in 1_u32..60
    ) {
        let (scene, exact) = balls_scene(size, eye, stepping(ConeRule::Exact));
        let past = overclaim(&scene, &exact, eye, steps, &mut Random::new(seed));
        prop_assert!(past <= 0.0, "{past} beyond");
    }

    #[test]
    fn no_ray_meets_the_slab_before_the_front(
        normal in normal(), size in slab_sizes(), eye in vector(6.0),
        seed in any::<u64>(), steps in 1_u32..60
    ) {
        let (scene, exact) = slab_scene(normal, size, eye, ConeRule::Exact);
        let past = overclaim(&scene, &exact, eye, steps, &mut Random::new(seed));
        prop_assert!(past <= 0.0, "{past} beyond");
    }

    #[test]
    fn fronts_hold_wherever_the_balls_are_sampled(
        size in sizes(), eye in vector(4.0), seed in any::<u64>()
    ) {
        let exact = balls(size.x, size.y, size.z);
        let past = sampled_anywhere(ConeRule::Exact, &exact, eye, &mut Random::new(seed));
        prop_assert!(past <= 0.0, "{past} beyond");
    }

    #[test]
    fn the_bounds_cut_no_part_of_a_ray_that_could_hit(
        eye in vector(9.0), aim in vector(4.0), flat in 0..8_usize,
        detail in 0.0..30.0, along in 0.0..1.0
    ) {
        // Every other ray is flat along some of the axes.
        let mut axis = aim - eye;
        for i in 0..3 {
            if flat & (1 << i) > 0 && axis.length() > 1.0 {
                axis[i] *= 1e-3;
            }
        }
        prop_assume!(axis.length() > 1e-3);
        let how = Stepping { detail, ..stepping(ConeRule::Exact) };
        let (scene, _) = balls_scene(DVec3::splat(0.1), eye, how);
        let ray = pixel_ray(axis.normalize());
        let (near, far) = scene.bounds_interval(&ray);
        let bounds = scene.formula.bounds();
        for part in 0..200 {
            let t = scene.bounds_far() * (f64::from(part) + along) / 200.0;
            let off = bounds.distance(eye + ray.at(t));
            let within = near <= t && t <= far;
            // Cut at 0.99 of the threshold, so that a ray starts within it for certain.
            let kept = 0.99 * detail * footprint(&ray, t) * (1.0 - 1e-9);
            prop_assert!(within || off >= kept, "{t} of {near} {far}");
            // Nor is more left than the corners of the threshold, but of rays so flat
            // that they may stay between two faces.
            let steep = ray.axis.abs().min_element() > 2.0 * detail * ray.grain;
            let corner = 1.74 * detail * footprint(&ray, t) + 1e-9;
            prop_assert!(!within || !steep || off <= corner, "{t} of {near} {far}");
        }
    }

    #[test]
    fn a_traced_ray_ends_where_it_meets_the_balls(
        size in sizes(), eye in vector(4.0), direction in normal(),
        relaxation in 0..3_usize, shell in 0.0..0.9
    ) {
        let relaxation = [Relaxation::Auto, Relaxation::Off, Relaxation::Factor(1.6)][relaxation];
        let how = Stepping { relaxation, shell, ..stepping(ConeRule::Exact) };
        let (scene, exact) = balls_scene(size, eye, how);
        let ray = pixel_ray(direction.normalize());
        let (hit, state) = trace(&scene, &ray, 0.0, 100_000, &mut Counts::default());
        let want = first_hit(&exact, eye, ray.axis);
        let width = footprint(&ray, hit.t);
        match state {
            State::Unconverged => prop_assert!(false, "unconverged at {}", hit.t),
            State::Sky => prop_assert!(want.is_infinite(), "missed a hit at {want}"),
            State::Hit => {
                prop_assert!(hit.t <= want + width, "{} past {want}", hit.t);
                // The last step is no longer than the distances at its ends together, and the hit is where
                // the line between them meets the threshold. As a distance grows no faster than the ray,
                // it is at most two thresholds, and the threshold grows a little along the step.
                let near = distance(&exact, eye + ray.at(hit.t));
                prop_assert!(near <= 2.02 * how.detail * width, "{}", near / (how.detail * width));
            }
        }
    }

    #[test]
    fn a_traced_ray_ends_where_it_meets_the_slab(
        normal in normal(), size in slab_sizes(), eye in vector(9.0), aim in vector(5.0)
    ) {
        let (scene, exact) = slab_scene(normal, size, eye, ConeRule::Exact);
        let ray = pixel_ray((aim - eye).normalize());
        let (hit, state) = trace(&scene, &ray, 0.0, 1, &mut Counts::default());
        let want = first_hit(&exact, eye, ray.axis);
        prop_assert_eq!(state == State::Hit, want.is_finite());
        if state == State::Hit {
            prop_assert!((hit.t - want).abs() < 1e-9 * (1.0 + want), "{} {want}", hit.t);
            let at = eye + ray.at(hit.t);
            let n = normal.normalize();
            let flat = at - at.dot(n) * n;
            let [u, v] = hit.uv;
            prop_assert!((flat.length() - u.hypot(v)).abs() < 1e-9);
            if want > 0.0 {
                let surface = scene.surface(&ray, &hit);
                let rim = flat.normalize_or_zero();
                let right = [-n, n, rim][hit.id as usize];
                prop_assert!(surface.normal.distance(right) < 1e-6);
                prop_assert!(surface.normal.dot(ray.axis) <= 1e-9, "seen from behind");
            }
        }
    }
}

/// A ray of a pixel a thousandth wide.
fn pixel_ray(axis: DVec3) -> Beam {
    Beam {
        origin: DVec3::ZERO,
        axis,
        r0: 0.0,
        k: 0.0,
        grain0: 0.0,
        grain: 1e-3,
    }
}

/// How far the front that a scene claims for a random cone lies beyond where one of the
/// cone's rays meets something.
fn overclaim<S: Solid>(
    scene: &S,
    exact: &[Exact],
    eye: DVec3,
    steps: u32,
    random: &mut Random,
) -> f64 {
    let cone = cone(random);
    let front = claimed(scene, &cone, steps);
    beyond(exact, eye, &cone, front, random)
}

#[test]
fn the_same_checks_find_the_slides_rule_wrong() {
    let size = DVec3::new(0.05, 0.7, 1.0);
    let slab_size = DVec3::new(0.5, 3.0, 0.0);
    // How many of 400 random cones claim more than holds.
    let wrong = |check: &dyn Fn(&mut Random) -> f64| {
        let seeds = (0..400).filter(|seed| check(&mut Random::new(*seed)) > 0.0);
        seeds.count()
    };
    for (rule, right) in [(ConeRule::Exact, true), (ConeRule::Slides, false)] {
        let found = [
            wrong(&|random| {
                let eye = 3.0 * random.direction();
                let (scene, exact) = balls_scene(size, eye, stepping(rule));
                overclaim(&scene, &exact, eye, 60, random)
            }),
            wrong(&|random| {
                let eye = 4.0 * random.direction();
                let (scene, exact) = slab_scene(DVec3::Z, slab_size, eye, rule);
                overclaim(&scene, &exact, eye, 60, random)
            }),
            wrong(&|random| {
                let eye = 3.0 * random.direction();
                sampled_anywhere(rule, &balls(size.x, size.y, size.z), eye, random)
            }),
        ];
        println!("{rule:?}: {found:?} of 400 cones claim too much");
        let as_expected = found.iter().all(|n| (*n == 0) == right);
        assert!(as_expected, "{rule:?}: {found:?}");
    }
}

#[test]
fn one_ball_carries_a_front_as_far_as_its_edge_ray_goes() {
    let random = &mut Random::new(9);
    for _ in 0..10_000 {
        let (t, k) = (random.between(0.0, 9.0), random.between(0.0, 2.0));
        // Away from tangency, where a root magnifies the share that is given up.
        let d = k * t * random.between(1.2, 3.0) + 0.01;
        let angle = 2.0 * (0.5 * k).asin();
        // Where the ray at the cone's edge leaves the ball about (0, 0, t).
        let (cos, sin) = (angle.cos(), angle.sin());
        let leaves = t * cos + (d * d - t * t * sin * sin).max(0.0).sqrt();
        let front = ConeRule::Exact.cone_front(t, t, d, k);
        assert!(
            front <= leaves && front >= leaves * (1.0 - 1e-4),
            "{front} {leaves}"
        );
        // At the start any cone, however wide, gains the ball's radius.
        let start = ConeRule::Exact.cone_front(0.0, 0.0, d, k);
        assert!(start <= d && start >= d * (1.0 - 2e-6));
        // No ball, no gain; a ball that is entered beyond the front leaves a gap.
        for none in [0.0, -d, f64::NAN] {
            assert_eq!(ConeRule::Exact.cone_front(t, t, none, k), t);
        }
        let apart = ConeRule::Exact.cone_front(t, t + 1.01 * d, d, 1e-3);
        assert_eq!(apart, t);
    }
}

/// The largest error of normals on the first ball, at points of a hit threshold in
/// footprints off its surface.
fn worst_normal(detail: f64) -> f64 {
    let eye = DVec3::new(0.2, -6.0, 0.3);
    let size = DVec3::new(0.05, 0.7, 1.0);
    let (scene, exact) = balls_scene(size, eye, stepping(ConeRule::Exact));
    let random = &mut Random::new(10);
    let (mut seen, mut worst) = (0, 0.0_f64);
    for _ in 0..2000 {
        let aim = 0.99 * random.direction();
        let ray = pixel_ray((aim - eye).normalize());
        let met = first_hit(&exact, eye, ray.axis);
        if (eye + ray.at(met)).length() > 1.0 + 1e-9 {
            continue;
        }
        // Back along the ray until the ball is as far as the threshold.
        let mut t = met;
        while distance(&exact, eye + ray.at(t)) < detail * footprint(&ray, t) {
            t -= 1e-4;
        }
        seen += 1;
        let right = (eye + ray.at(t)).normalize();
        let hit = Hit {
            t,
            ..Hit::default()
        };
        let normal = scene.surface(&ray, &hit).normal;
        assert!((normal.length() - 1.0).abs() < 1e-9);
        worst = worst.max(normal.distance(right));
    }
    assert!(seen > 1000, "only {seen}");
    worst
}

#[test]
fn normals_of_the_balls_face_outwards_however_close_to_the_surface() {
    for detail in [2.0, 1.0, 0.5, 0.1, 0.0] {
        let worst = worst_normal(detail);
        assert!(worst < 0.01, "{worst} at {detail}");
    }
}
