//! Cones and rays at random, and the check that no ray of a cone meets anything before
//! the front that is claimed for it.

use conemarch::base::cone::ConeRule;
use conemarch::base::outcome::Counts;
use conemarch::base::view::Beam;
use conemarch::scene::{Advance, Solid};
use glam::DVec3;

use super::common::exact::{Exact, distance, first_hit};
use super::common::random::Random;

/// A random cone from the eye: chord up to 2, rays up to a tenth apart at the start.
pub fn cone(random: &mut Random) -> Beam {
    let wide = 2.0 * random.unit();
    Beam {
        origin: random.cube(0.2),
        axis: random.direction(),
        r0: if random.unit() < 0.5 {
            0.0
        } else {
            0.1 * random.unit()
        },
        // Wide cones hardly move: most of the cones are narrow.
        k: wide.powi(4) / 8.0,
        grain0: 0.0,
        grain: 1e-3 * random.unit(),
    }
}

/// A ray of a cone, origin and direction; half of all lie at the cone's edge.
pub fn ray_of(cone: &Beam, random: &mut Random) -> (DVec3, DVec3) {
    let edge = random.unit() < 0.5;
    let share = |random: &mut Random| if edge { 1.0 } else { random.unit().sqrt() };
    let offset = cone.r0 * share(random) * random.direction();
    // A chord c between unit vectors spans the angle 2 asin(c / 2).
    let chord = cone.k * share(random) * (1.0 - 1e-12);
    let angle = 2.0 * (0.5 * chord).min(1.0).asin();
    let turn = std::f64::consts::TAU * random.unit();
    let (u, v) = cone.axis.any_orthonormal_pair();
    let side = turn.cos() * u + turn.sin() * v;
    let axis = (angle.cos() * cone.axis + angle.sin() * side).normalize();
    (cone.origin + offset, axis)
}

/// The front that a solid claims for a cone after so many steps.
pub fn claimed<S: Solid>(solid: &S, cone: &Beam, steps: u32) -> f64 {
    let work = &mut Counts::default();
    let mut at = Advance::at(0.0, true);
    for _ in 0..steps {
        let next = solid.advance(cone, at, work);
        assert!(next.front >= at.front, "a front went back");
        at = next;
        if !next.going || next.front > solid.bounds_far() {
            break;
        }
    }
    at.front
}

/// A cone's front after samples of the field at random places: at the front, far ahead of
/// it, behind it, and at the start. How far it lies beyond what the cone's rays meet.
pub fn sampled_anywhere(rule: ConeRule, exact: &[Exact], eye: DVec3, random: &mut Random) -> f64 {
    let cone = Beam {
        r0: 0.0,
        ..cone(random)
    };
    let mut front = 0.0;
    for _ in 0..24 {
        let t = match (4.0 * random.unit()) as u32 {
            0 => front,
            1 => front * random.between(1.0, 1.5) + random.between(0.0, 0.3),
            2 => front * random.unit(),
            _ => 0.0,
        };
        let d = distance(exact, eye + cone.at(t));
        let next = rule.cone_front(front, t, d, cone.k);
        assert!(next >= front, "a front went back");
        front = next;
    }
    beyond(exact, eye, &cone, front, random)
}

/// How far a claimed front lies beyond the first meeting of any of 64 random rays of the
/// cone; at most 0 if the claim holds. Beams are relative to the eye.
pub fn beyond(exact: &[Exact], eye: DVec3, cone: &Beam, front: f64, random: &mut Random) -> f64 {
    let past = (0..64).map(|_| {
        let (origin, axis) = ray_of(cone, random);
        front - first_hit(exact, eye + origin, axis)
    });
    past.fold(f64::NEG_INFINITY, f64::max)
}
