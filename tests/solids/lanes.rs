//! Several points, rays or cones side by side against one by one: every bit is the same.

use conemarch::base::cone::ConeRule;
use conemarch::base::lanes::{LANES, Places};
use conemarch::base::outcome::Counts;
use conemarch::base::view::View;
use conemarch::formula::mandelbox::{Estimate, Mandelbox};
use conemarch::formula::{DistanceEstimate, Evaluator, Formula, Reading};
use conemarch::pass::follow::{Start, follow, follow_all};
use conemarch::pass::march::{march, march_all};
use conemarch::scene::Solid;
use conemarch::scene::distance::Distance;
use glam::DVec3;

use crate::common::random::Random;
use crate::stepping;

/// Mandelboxes of all kinds: estimates, signs of the scale, rotations, Julia mode, radii, limits.
fn boxes() -> Vec<Mandelbox> {
    let mut all = Vec::new();
    for scale in [2.0, -1.5, 3.0, -2.6, 1.2] {
        for rotation in [DVec3::ZERO, DVec3::new(12.0, -8.0, 25.0)] {
            for julia in [false, true] {
                for estimate in [Estimate::Tight, Estimate::Scalar, Estimate::Classic] {
                    all.push(Mandelbox {
                        scale,
                        rotation,
                        julia,
                        estimate,
                        min_radius: 0.4,
                        fixed_radius: 1.1,
                        fold_limit: 0.9,
                        julia_constant: DVec3::new(0.7, -0.4, 1.1),
                        ..Mandelbox::default()
                    });
                }
            }
        }
    }
    all
}

/// Asserts that lanes tell what single points tell.
fn assert_same(all: &[Reading; LANES], at: &Places, one: impl Fn(usize, DVec3) -> Reading) {
    for (i, lane) in all.iter().enumerate().filter(|(i, _)| at.on[*i]) {
        let one = one(i, at.points[i]);
        let bits = |r: &Reading| (r.value.to_bits(), r.radius.to_bits(), r.iterations);
        assert_eq!(bits(lane), bits(&one), "{lane:?} {one:?} {}", at.points[i]);
    }
}

#[test]
fn orbits_side_by_side_have_the_bits_of_single_ones() {
    let random = &mut Random::new(5);
    for shape in boxes() {
        let of: Evaluator = shape.evaluator();
        assert!(of.has_lanes());
        for most in [0, 1, 2, 3, 4, 7, 20, 60] {
            for _ in 0..60 {
                let half = random.between(0.1, 1.5) * shape.bounds().half.max_element();
                let at = Places {
                    points: [(); LANES].map(|()| random.cube(half)),
                    on: [(); LANES].map(|()| random.unit() < 0.8),
                };
                let size = 10.0_f64.powf(random.between(-6.0, 1.0));
                let sizes = [(); LANES].map(|()| size * random.unit() + 1e-12);
                let steps = of.steps(&at, most, &sizes);
                assert_same(&steps, &at, |i, p| of.step(p, most, sizes[i]));
                let cones = of.cones(&at, most, &sizes);
                assert_same(&cones, &at, |i, p| of.cone(p, most, sizes[i]));
                let balls = of.balls(&at, most, &sizes);
                assert_same(&balls, &at, |i, p| of.ball(p, most, sizes[i]));
                let values = of.values(&at, most);
                for i in (0..LANES).filter(|i| at.on[*i]) {
                    let (value, _) = of.value(at.points[i], most);
                    assert_eq!(values[i].to_bits(), value.to_bits(), "{}", at.points[i]);
                }
            }
        }
    }
}

#[test]
fn rays_and_cones_side_by_side_end_as_single_ones() {
    for (nth, shape) in boxes().into_iter().enumerate() {
        let eye = shape.bounds().half * DVec3::new(1.4, -1.9, 1.1);
        let view = View::new(eye, DVec3::ZERO, DVec3::Z, 50.0, [40, 30]);
        let mut stepping = stepping(ConeRule::Exact);
        stepping.detail = 1.0;
        stepping.proven = nth % 2 == 1;
        let scene = Distance::new(Formula::Mandelbox(shape), 14, eye, stepping);
        let pixels = (0..40 * 30).map(|i| [i % 40, i / 40]);
        let start = |pixel| Start {
            ray: view.view_ray(pixel),
            front: 0.0,
            far: scene.bounds_far(),
        };
        let starts: Vec<Start> = pixels.map(start).collect();
        // The second limit ends most rays under way.
        for limit in [200, 6] {
            let ends = follow_all(&scene, &starts, limit);
            let mut kinds = std::collections::BTreeSet::new();
            for (start, end) in starts.iter().zip(&ends) {
                let one = follow(&scene, start, limit);
                assert_eq!(end.hit.t.to_bits(), one.hit.t.to_bits());
                assert_eq!((end.step, end.work), (one.step, one.work));
                kinds.insert(format!("{:?}", end.step));
            }
            assert!(kinds.len() > 1, "all rays ended in the same way: {kinds:?}");
        }
        let cells = (0..10 * 7).map(|i| [i % 10, i / 10]);
        let cones: Vec<_> = cells.map(|cell| (view.view_cone(cell, 4), 0.0)).collect();
        for limit in [200, 2] {
            let ends = march_all(&scene, &cones, limit);
            for ((cone, front), end) in cones.iter().zip(ends) {
                let mut work = Counts::default();
                let one = march(&scene, cone, *front, limit, &mut work);
                assert_eq!(end.0.to_bits(), one.0.to_bits());
                assert_eq!((end.1, end.2), (one.1, work));
            }
        }
        let hits: Vec<_> = follow_all(&scene, &starts, 200)
            .iter()
            .zip(&starts)
            .map(|(end, start)| (start.ray, end.hit))
            .collect();
        for part in hits.chunks(LANES) {
            for ((ray, hit), surface) in part.iter().zip(scene.surfaces(part)) {
                assert_eq!(surface, scene.surface(ray, hit));
            }
        }
    }
}
