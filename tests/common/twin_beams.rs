//! Cones and rays in scenes: fronts, empty balls, walks, hits and bounds agree.

use super::probe::{Allowed, Errors, Numbers, agree_unless_moved, probe};
use super::random::Random;
use super::setups::{
    MOVED, balls, beam, beams, four, heightfield_plan, probe_of, shape_plan, slab_plan,
};
use conemarch::base::work::Work;
use conemarch::formula::Formula;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::plan::Plan;
use conemarch::scene::AnySolid;
use conemarch::scene::Assets;
use conemarch::scene::distance::Relaxation;
use conemarch::scene::slab::SlabSettings;
use conemarch::scene::{Solid, Step};
use glam::DVec3;

/// Errors of fronts, decisions, clearances, walks and hits of beams.
struct BeamErrors {
    advance: Errors,
    going: Errors,
    clearance: Errors,
    walk: Errors,
    step: Errors,
    mark: Errors,
}

fn beam_errors(gpu: &Plan, cpu: &Plan, steps: f64) -> BeamErrors {
    let asked = beams(cpu, 3.0, steps, 5);
    let told = probe_of(gpu, probe!("beam")).ask(&asked);
    match cpu.solid(&Assets::default()).unwrap() {
        AnySolid::Distance(s) => beam_errors_of(&s, &asked, &told),
        AnySolid::Heightfield(s) => beam_errors_of(&s, &asked, &told),
        AnySolid::Slab(s) => beam_errors_of(&s, &asked, &told),
    }
}

fn beam_errors_of<S: Solid>(solid: &S, asked: &[Numbers], told: &[Numbers]) -> BeamErrors {
    let (mut fronts, mut going, mut clear) = (vec![], vec![], vec![]);
    let (mut walks, mut ends, mut marks) = (vec![], vec![], vec![]);
    for (q, a) in asked.iter().zip(told) {
        let (ray, front, work) = (beam(q), f64::from(q[0][3]), &mut Work::default());
        let next = solid.advance(&ray, front, work);
        // What is gained: the front itself would hide an error behind the way so far.
        fronts.push(((f64::from(a[0][0]) - front) as f32, next.front - front));
        going.push((a[0][1], f64::from(u8::from(next.going))));
        clear.push((a[0][2], solid.clearance(ray.at(front))));
        let mut walk = solid.begin(&ray, front, f64::from(q[2][2]), work);
        let mut step = Step::Moving;
        for _ in 0..q[2][3] as u32 {
            step = solid.walk_step(&ray, &mut walk, work);
            if step != Step::Moving {
                break;
            }
        }
        let state = match step {
            Step::Moving => 3.0,
            Step::Hit => 1.0,
            Step::Out => 0.0,
            Step::Spent => 2.0,
        };
        let hit = solid.walk_hit(&walk);
        walks.extend([(a[1][0], hit.t), (a[1][3], solid.walk_radius(&ray, &walk))]);
        ends.push((a[1][1], state));
        marks.extend([
            (a[1][2], f64::from(hit.id)),
            (a[2][0], hit.uv[0]),
            (a[2][1], hit.uv[1]),
        ]);
    }
    BeamErrors {
        advance: Errors::of(fronts, 0.1),
        going: Errors::of(going, 1.0),
        clearance: Errors::of(clear, 0.1),
        walk: Errors::of(walks, 0.1),
        step: Errors::of(ends, 1.0),
        mark: Errors::of(marks, 0.1),
    }
}

#[test]
fn beams_in_a_distance_scene_agree() {
    let eye = DVec3::new(1.0, -6.0, 2.5);
    let of = |factor: f64, stride: f64, relaxation| {
        let mut plan = shape_plan(balls(factor), 1, eye);
        plan.march.stride = Some(stride);
        plan.march.relaxation = relaxation;
        // A ray that starts where it enters the bounds starts at the threshold itself,
        // where f32 may well decide otherwise.
        plan.march.clip = Some(false);
        plan
    };
    let allowed = Allowed {
        median: 1e-6,
        p99: 1e-5,
    };
    for relaxation in [Relaxation::Auto, Relaxation::Off, Relaxation::Factor(1.4)] {
        for steps in [1.0, 4.0, 9.0] {
            let cpu = of(1.0, 0.9, relaxation);
            let own = beam_errors(&cpu, &cpu, steps);
            let moved = beam_errors(&of(MOVED, 0.9, relaxation), &cpu, steps);
            let name = format!("after {steps} steps, {relaxation:?}");
            agree_unless_moved(
                &format!("advance {name}"),
                allowed,
                own.advance,
                moved.advance,
            );
            agree_unless_moved(
                &format!("clearance {name}"),
                allowed,
                own.clearance,
                moved.clearance,
            );
            let strides = beam_errors(&of(1.0, 0.9 * MOVED, relaxation), &cpu, steps);
            agree_unless_moved(&format!("walk {name}"), allowed, own.walk, strides.walk);
            // Decisions agree but for a few at a threshold.
            let few = Allowed {
                median: 0.0,
                p99: 0.0,
            };
            assert!(own.going.within(few) && own.step.within(few), "{name}");
        }
    }
}

#[test]
fn beams_in_a_mandelbox_agree() {
    let of = |scale: f64| {
        let m = Mandelbox {
            scale,
            ..Mandelbox::default()
        };
        let mut plan = shape_plan(Formula::Mandelbox(m), 8, DVec3::new(3.0, -12.0, 5.0));
        plan.march.clip = Some(false);
        plan
    };
    let own = beam_errors(&of(2.0), &of(2.0), 4.0);
    let moved = beam_errors(&of(2.0 * MOVED), &of(2.0), 4.0);
    let allowed = Allowed {
        median: 1e-5,
        p99: 2e-4,
    };
    agree_unless_moved("advance, mandelbox", allowed, own.advance, moved.advance);
    agree_unless_moved("walk, mandelbox", allowed, own.walk, moved.walk);
}

#[test]
fn the_part_of_a_ray_near_the_bounds_agrees() {
    let of = |scale: f64| {
        let m = Mandelbox {
            scale,
            rotation: DVec3::X,
            ..Mandelbox::default()
        };
        shape_plan(Formula::Mandelbox(m), 6, DVec3::new(9.0, -17.0, 8.0))
    };
    let plan = of(2.0);
    let AnySolid::Distance(scene) = plan.solid(&Assets::default()).unwrap() else {
        unreachable!("a distance scene");
    };
    let mut random = Random::new(6);
    let question = |_| {
        let axis = (random.cube(12.0) - plan.camera.eye).normalize();
        let grain = DVec3::Y * random.between(0.0, 0.001);
        [
            four(random.cube(0.1), 0.0),
            four(axis, 0.0),
            four(grain, 0.0),
        ]
    };
    let asked: Vec<Numbers> = (0..8192).map(question).collect();
    let errors = |gpu: &Plan| {
        let told = probe_of(gpu, probe!("interval")).ask(&asked);
        let pair = |(q, a): (&Numbers, &Numbers)| {
            let (near, far) = scene.bounds_interval(&beam(q));
            [(a[0][0], near), (a[0][1], far)]
        };
        Errors::of(asked.iter().zip(&told).flat_map(pair), 1.0)
    };
    let allowed = Allowed {
        median: 3e-6,
        p99: 2e-5,
    };
    agree_unless_moved(
        "bounds_interval",
        allowed,
        errors(&plan),
        errors(&of(2.0 * MOVED)),
    );
    // Nothing within the bounds is cut off: where f32 starts later than f64 it is still
    // outside them, but for the rounding of a position 30 away.
    let told = probe_of(&plan, probe!("interval")).ask(&asked);
    let bounds = scene.formula.bounds();
    for (q, a) in asked.iter().zip(&told) {
        let ray = beam(q);
        let (near, far) = scene.bounds_interval(&ray);
        let [start, end] = [0, 1].map(|i| f64::from(a[0][i]));
        let at = plan.camera.eye - bounds.centre + ray.at(start);
        let outside = (at.abs() - bounds.half).max_element();
        let held = (start <= near || outside > -3e-6) && end >= far;
        assert!(near > far || held, "{near} {far} {outside} {a:?}");
    }
}

#[test]
fn the_heightfield_agrees() {
    let of = |factor: f64| heightfield_plan(2.0 * factor);
    let own = beam_errors(&of(1.0), &of(1.0), 6.0);
    let moved = beam_errors(&of(MOVED), &of(1.0), 6.0);
    let allowed = Allowed {
        median: 1e-6,
        p99: 1e-4,
    };
    agree_unless_moved(
        "clearance, heightfield",
        allowed,
        own.clearance,
        moved.clearance,
    );
    agree_unless_moved("walk, heightfield", allowed, own.walk, moved.walk);
    // Fronts are the way so far or one of a row of halved lengths: all or nothing, and
    // the depth is no part of the lengths.
    let fronts = Allowed {
        median: 1e-6,
        p99: 1e-5,
    };
    assert!(own.advance.within(fronts), "{:?}", own.advance);
}

#[test]
fn the_slab_agrees() {
    let of = |factor: f64| {
        slab_plan(SlabSettings {
            normal: DVec3::new(0.3, -0.2, 1.0),
            half: 0.5 * factor,
            radius: 6.0 * factor,
        })
    };
    let own = beam_errors(&of(1.0), &of(1.0), 1.0);
    let moved = beam_errors(&of(MOVED), &of(1.0), 1.0);
    let allowed = Allowed {
        median: 2e-7,
        p99: 1e-6,
    };
    agree_unless_moved("advance, slab", allowed, own.advance, moved.advance);
    agree_unless_moved("clearance, slab", allowed, own.clearance, moved.clearance);
    agree_unless_moved("walk, slab", allowed, own.walk, moved.walk);
    let allowed = Allowed {
        median: 3e-7,
        p99: 2e-5,
    };
    agree_unless_moved("mark, slab", allowed, own.mark, moved.mark);
    let few = Allowed {
        median: 0.0,
        p99: 0.0,
    };
    assert!(own.step.within(few) && own.going.within(few));
}
