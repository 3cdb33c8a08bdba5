//! Cones and rays in scenes: fronts, empty balls, walks, hits and bounds agree.

use conemarch::base::outcome::Counts;
use conemarch::base::view::Beam;
use conemarch::plan::Plan;
use conemarch::scene::stepping::Relaxation;
use conemarch::scene::{Advance, Solid, Step, Task};
use glam::DVec3;

use super::common::plans::{boxed, distance, distance_solid, mandelbox, scene, solid};
use super::common::probe::{Numbers, probe};
use super::common::setups::{four, probe_of, seen_from};
use super::compare::{Allowed, DECIDED, MOVED, Pairs, Quantities, Twins, questions};
use super::{balls, three};

/// The beam of a question.
pub fn beam(q: &Numbers) -> Beam {
    Beam {
        origin: three(q[0]),
        axis: three(q[1]),
        r0: f64::from(q[2][0]),
        k: f64::from(q[1][3]),
        grain0: 0.0,
        grain: f64::from(q[2][1]),
    }
}

/// A comparison of the cones and rays of a scene.
struct Beams<'a> {
    what: &'a str,
    plan: &'a Plan,
    /// Steps that each ray takes.
    steps: f64,
    quantities: Quantities<'a>,
    /// Plans that are moved, with the quantities in which this must be seen.
    moved: &'a [(&'a str, Plan)],
}

impl Task for Beams<'_> {
    type Output = ();

    fn run<S: Solid>(self, solid: &S) {
        let far = solid.bounds_far();
        // From near the eye towards points about the origin: origin and front, axis and
        // chord, r0, grain, t_max and steps.
        let asked = questions(5, |random| {
            let origin = random.cube(0.01);
            let axis = (random.cube(3.0) - self.plan.camera.eye).normalize();
            let front = far * random.between(0.0, 0.45);
            let (k, r0) = (random.between(0.0, 0.1), random.between(0.0, 0.02));
            let grain = random.between(0.001, 0.01);
            let end = DVec3::new(r0, grain, random.between(0.8, 2.0) * far);
            [four(origin, front), four(axis, k), four(end, self.steps)]
        });
        let twins = Twins::new(&asked, self.quantities, |pairs, q, a| {
            pair(solid, pairs, q, a)
        });
        let probe = |plan: &Plan| probe_of(plan, probe!("beam"));
        let moved = self.moved.iter().map(|(seen, plan)| (*seen, probe(plan)));
        twins.assert_agree(self.what, &probe(self.plan), &moved.collect::<Vec<_>>());
    }
}

/// Adds what a scene answers in f64.
fn pair<S: Solid>(solid: &S, pairs: &mut Pairs, q: &Numbers, a: &Numbers) {
    let (ray, front, work) = (beam(q), f64::from(q[0][3]), &mut Counts::default());
    let next = solid.advance(&ray, Advance::at(front, true), work);
    // What is gained: the front itself would hide an error behind the way so far.
    let gained = (f64::from(a[0][0]) - front) as f32;
    pairs.add("advance", gained, next.front - front);
    pairs.add("going", a[0][1], f64::from(u8::from(next.going)));
    pairs.add("clearance", a[0][2], solid.clearance(ray.at(front)));
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
    pairs.add("walk", a[1][0], hit.t);
    pairs.add("step", a[1][1], state);
    pairs.add("mark", a[1][2], f64::from(hit.id));
    pairs.add("mark", a[2][0], hit.uv[0]);
    pairs.add("mark", a[2][1], hit.uv[1]);
}

#[test]
fn beams_in_a_distance_scene_agree() {
    let of = |factor: f64, stride: f64, relaxation| {
        let mut plan = seen_from([1.0, -6.0, 2.5], distance(balls(factor), Some(1)));
        plan.march.stride = Some(stride);
        plan.march.relaxation = relaxation;
        // A ray that starts where it enters the bounds starts at the threshold itself,
        // where f32 may well decide otherwise.
        plan.march.clip = Some(false);
        plan
    };
    for relaxation in [Relaxation::Auto, Relaxation::Off, Relaxation::Factor(1.4)] {
        for steps in [1.0, 4.0, 9.0] {
            let plan = &of(1.0, 0.9, relaxation);
            let moved = [
                ("advance clearance", of(MOVED, 0.9, relaxation)),
                ("walk", of(MOVED, 0.9, relaxation)),
                ("walk", of(1.0, 0.9 * MOVED, relaxation)),
            ];
            solid(plan).run(Beams {
                what: &format!("after {steps} steps, {relaxation:?}"),
                plan,
                steps,
                quantities: &[
                    ("advance clearance walk", 0.1, Allowed(1e-6, 1e-5)),
                    ("going step", 0.1, DECIDED),
                ],
                // After one step, a ray is where it began.
                moved: match steps > 1.0 {
                    true => &moved,
                    false => &moved[..1],
                },
            });
        }
    }
}

#[test]
fn beams_in_a_mandelbox_agree() {
    let of = |scale: f64| {
        let mut plan = seen_from([3.0, -12.0, 5.0], boxed(mandelbox(scale), Some(8)));
        plan.march.clip = Some(false);
        plan
    };
    let plan = &of(2.0);
    solid(plan).run(Beams {
        what: "mandelbox",
        plan,
        steps: 4.0,
        quantities: &[("advance walk", 0.1, Allowed(1e-5, 2e-4))],
        moved: &[("advance walk", of(2.0 * MOVED))],
    });
}

/// The plan of any other scene, given by its keys, from the same place.
fn scene_of(keys: &str) -> Plan {
    seen_from([4.0, -9.0, 6.0], scene(keys))
}

#[test]
fn the_heightfield_agrees() {
    let of = |factor: f64| {
        scene_of(&format!(
            "kind = 'heightfield'\ndepth = {}\nturn = [5, -8, 30]\nfield = 'fbm:33x25,seed=3,power=3'",
            2.0 * factor
        ))
    };
    let plan = &of(1.0);
    solid(plan).run(Beams {
        what: "heightfield",
        plan,
        steps: 6.0,
        quantities: &[
            ("clearance walk", 0.1, Allowed(1e-6, 1e-4)),
            ("advance", 0.1, Allowed(1e-6, 2e-5)),
        ],
        moved: &[("advance clearance walk", of(MOVED))],
    });
}

#[test]
fn the_slab_agrees() {
    let of = |factor: f64| {
        let (half, radius) = (0.5 * factor, 6.0 * factor);
        scene_of(&format!(
            "kind = 'slab'\nnormal = [0.3, -0.2, 1]\nhalf = {half}\nradius = {radius}"
        ))
    };
    let plan = &of(1.0);
    solid(plan).run(Beams {
        what: "slab",
        plan,
        steps: 1.0,
        quantities: &[
            ("advance clearance walk", 0.1, Allowed(2e-7, 1e-6)),
            ("mark", 0.1, Allowed(3e-7, 2e-5)),
            ("going step", 0.1, DECIDED),
        ],
        moved: &[("advance clearance walk mark", of(MOVED))],
    });
}

#[test]
fn the_part_of_a_ray_near_the_bounds_agrees() {
    let of = |scale: f64| {
        let mut m = mandelbox(scale);
        m.rotation = DVec3::X;
        seen_from([9.0, -17.0, 8.0], boxed(m, Some(6)))
    };
    let plan = of(2.0);
    let scene = distance_solid(&plan);
    let asked = questions(6, |random| {
        let axis = (random.cube(12.0) - plan.camera.eye).normalize();
        let grain = DVec3::Y * random.between(0.0, 0.001);
        [random.cube(0.1), axis, grain].map(|v| four(v, 0.0))
    });
    let quantities = [("interval", 1.0, Allowed(3e-6, 2e-5))];
    let twins = Twins::new(&asked, &quantities, |pairs, q, a| {
        let (near, far) = scene.bounds_interval(&beam(q));
        pairs.add("interval", a[0][0], near);
        pairs.add("interval", a[0][1], far);
    });
    let probe = |plan: &Plan| probe_of(plan, probe!("interval"));
    let moved = [("interval", probe(&of(2.0 * MOVED)))];
    twins.assert_agree("mandelbox", &probe(&plan), &moved);
    // Nothing within the bounds is cut off: where f32 starts later than f64 it is still
    // outside them, but for the rounding of a position 30 away.
    let bounds = scene.formula.bounds();
    for (q, a) in asked.iter().zip(&probe(&plan).ask(&asked)) {
        let ray = beam(q);
        let (near, far) = scene.bounds_interval(&ray);
        let [start, end] = [0, 1].map(|i| f64::from(a[0][i]));
        let at = plan.camera.eye - bounds.centre + ray.at(start);
        let outside = (at.abs() - bounds.half).max_element();
        let held = (start <= near || outside > -3e-6) && end >= far;
        assert!(near > far || held, "{near} {far} {outside} {a:?}");
    }
}
