//! The check that no ray of a cone meets anything before the front that is claimed for it.

use conemarch::base::cone::ConeRule;
use conemarch::base::view::Beam;
use glam::DVec3;

use super::common::cones::{cone, ray_of};
use super::common::exact::{Exact, distance, first_hit};
use super::common::random::Random;

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
