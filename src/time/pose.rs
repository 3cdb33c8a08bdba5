//! The path of a camera.
//!
//! A [`Pose`] is the similarity transform from a camera's own space to the world: a turn, a
//! move, and a scale, which is the distance from eye to target. Two poses are joined by
//! the one-parameter subgroup of similarities that leads from one to the other. So a camera that
//! only turns stays in its place, one that circles its target keeps its distance, and one that
//! zooms comes nearer by the same factor in the same time.
//!
//! The integral `p(u) = int_0^u exp(s (sigma + [w]x)) ds` of the move has a closed form along
//! the axis `w` and, as a complex number, across it.
//!
//! A path through many poses is the spline of Catmull and Rom in the form of Barry and Goldman
//! (A recursive evaluation algorithm for a class of Catmull-Rom splines, 1988), which only ever
//! joins two poses.

use glam::{DMat3, DQuat, DVec2, DVec3};

/// Where a camera is, where it looks, and how far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Its place.
    pub eye: DVec3,
    /// From its own space (right, up, backward) to the world.
    pub turn: DQuat,
    /// The distance to its target, more than 0.
    pub distance: f64,
}

/// `exp(z) - 1` of a complex number, without cancellation.
fn exp_m1(z: DVec2) -> DVec2 {
    let half = (0.5 * z.y).sin();
    DVec2::new(
        z.x.exp_m1() * z.y.cos() - 2.0 * half * half,
        z.x.exp() * z.y.sin(),
    )
}

fn quotient(a: DVec2, b: DVec2) -> DVec2 {
    DVec2::new(a.dot(b), b.perp_dot(a)) / b.length_squared()
}

/// `(exp(u z) - 1) / (exp(z) - 1)`, and its limit `u` at 0.
fn share(z: DVec2, u: f64) -> DVec2 {
    let whole = exp_m1(z);
    match whole.length_squared() > 1e-24 {
        true => quotient(exp_m1(u * z), whole),
        false => DVec2::new(u, 0.0),
    }
}

impl Pose {
    /// The pose of a camera. Its target is not its eye, and `up` is not along the view.
    pub fn new(eye: DVec3, target: DVec3, up: DVec3) -> Self {
        let backward = (eye - target).normalize();
        let right = up.cross(backward).normalize();
        let turn = DMat3::from_cols(right, backward.cross(right), backward);
        Self {
            eye,
            turn: DQuat::from_mat3(&turn),
            distance: eye.distance(target),
        }
    }

    /// The point that it looks at.
    pub fn target(&self) -> DVec3 {
        self.eye + self.turn * DVec3::NEG_Z * self.distance
    }

    /// Its upward direction.
    pub fn up(&self) -> DVec3 {
        self.turn * DVec3::Y
    }

    /// The pose at a share of the way to another: 0 is here, 1 is there; others lie before and
    /// beyond.
    pub fn toward(&self, other: &Self, u: f64) -> Self {
        let mut by = self.turn.inverse() * other.turn;
        // Of the two ways round, the short one.
        if by.w < 0.0 {
            by = -by;
        }
        let (axis, angle) = by.to_axis_angle();
        let growth = (other.distance / self.distance).ln();
        let way = self.turn.inverse() * (other.eye - self.eye);
        let along = axis * axis.dot(way);
        let across = way - along;
        let part = share(DVec2::new(growth, angle), u);
        let moved = along * share(DVec2::new(growth, 0.0), u).x
            + across * part.x
            + axis.cross(across) * part.y;
        Self {
            eye: self.eye + self.turn * moved,
            turn: (self.turn * DQuat::from_axis_angle(axis, u * angle)).normalize(),
            distance: self.distance * (u * growth).exp(),
        }
    }

    /// The pose at a time between the second and the third of four, on a smooth path through all.
    /// Their times ascend.
    pub fn on_spline(poses: [(f64, Self); 4], at: f64) -> Self {
        let join = |a: &(f64, Self), b: &(f64, Self), [from, to]: [f64; 2]| {
            (at, a.1.toward(&b.1, (at - from) / (to - from)))
        };
        let times = poses.map(|(time, _)| time);
        let first = [0, 1, 2].map(|i| join(&poses[i], &poses[i + 1], [times[i], times[i + 1]]));
        let second = [0, 1].map(|i| join(&first[i], &first[i + 1], [times[i], times[i + 2]]));
        join(&second[0], &second[1], [times[1], times[2]]).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: DVec3, b: DVec3) -> bool {
        a.distance(b) < 1e-9 * (1.0 + a.length())
    }

    fn level(eye: DVec3, target: DVec3) -> Pose {
        Pose::new(eye, target, DVec3::Z)
    }

    #[test]
    fn a_pose_leads_to_the_other() {
        let a = Pose::new(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, DVec3::Z);
        let b = Pose::new(DVec3::new(-4.0, 0.3, 1.0), DVec3::X, DVec3::Y);
        for (u, pose) in [(0.0, a), (1.0, b)] {
            let there = a.toward(&b, u);
            assert!(near(there.eye, pose.eye), "{there:?}");
            assert!(near(there.target(), pose.target()));
            assert!(near(there.up(), pose.up()));
        }
        // The way has no begin: halfway on is the same from there.
        let middle = a.toward(&b, 0.5);
        assert!(near(middle.toward(&b, 0.5).eye, a.toward(&b, 0.75).eye));
    }

    #[test]
    fn who_only_turns_stays_in_place() {
        let eye = DVec3::new(5.0, 1.0, 0.2);
        let (a, b) = (
            level(eye, DVec3::ZERO),
            level(eye, DVec3::new(5.0, 90.0, 3.0)),
        );
        assert!(near(a.toward(&b, 0.4).eye, eye));
    }

    #[test]
    fn who_circles_the_target_keeps_the_distance_and_the_level() {
        let at = |angle: f64| {
            let round = DVec3::new(angle.cos(), angle.sin(), 0.5);
            level(DVec3::X + 3.0 * round, DVec3::X)
        };
        let expected = at(0.7);
        let there = at(0.2).toward(&at(1.7), 1.0 / 3.0);
        assert!(near(there.eye, expected.eye));
        assert!(near(there.target(), DVec3::X));
        assert!(near(there.up(), expected.up()));
    }

    #[test]
    fn a_zoom_is_even() {
        let from = |d: f64| level(DVec3::new(0.0, -d, 0.0), DVec3::ZERO);
        let (far, close) = (from(10.0), from(1e-5));
        for (u, distance) in [(0.5, 1e-2), (1.0 / 3.0, 0.1), (1.0, 1e-5)] {
            let there = far.toward(&close, u);
            assert!((there.eye.y / -distance - 1.0).abs() < 1e-9, "{there:?}");
            assert!(there.target().length() < 1e-12);
        }
    }

    #[test]
    fn the_spline_passes_through_its_poses_without_a_bend() {
        let at = |x: f64, y: f64, time: f64| (time, level(DVec3::new(x, y, 1.0), DVec3::ZERO));
        let poses = [
            at(3.0, 0.0, 0.0),
            at(2.0, 2.0, 1.0),
            at(-1.0, 3.0, 2.5),
            at(-4.0, 1.0, 3.0),
            at(-5.0, -3.0, 4.0),
        ];
        let first = [poses[0], poses[1], poses[2], poses[3]];
        let second = [poses[1], poses[2], poses[3], poses[4]];
        assert!(near(Pose::on_spline(first, 1.0).eye, poses[1].1.eye));
        assert!(near(Pose::on_spline(first, 2.5).eye, poses[2].1.eye));
        let step = 1e-5;
        let before = poses[2].1.eye - Pose::on_spline(first, 2.5 - step).eye;
        let after = Pose::on_spline(second, 2.5 + step).eye - poses[2].1.eye;
        let (before, after) = (before / step, after / step);
        assert!(
            before.distance(after) < 1e-3 * before.length(),
            "{before} {after}"
        );
    }
}
