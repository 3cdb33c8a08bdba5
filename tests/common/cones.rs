//! Cones at random, rays of a cone, and the front that a scene claims for one.

use conemarch::base::outcome::Counts;
use conemarch::base::view::Beam;
use conemarch::scene::{Advance, Solid};
use glam::DVec3;

use super::random::Random;

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
