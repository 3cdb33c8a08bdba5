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
//! A path through many poses is a cubic Hermite spline in the cumulative form of Kim, Kim and Shin
//! (A general construction scheme for unit quaternion curves with simple high order derivatives,
//! 1995), here of similarities. Its velocity at a pose is the harmonic mean of the mean velocities
//! before and after (Fritsch and Butland, A method for constructing local monotone piecewise cubic
//! interpolants, 1984). This is at most twice the slower one, so a camera does not swing out,
//! however unevenly its keys follow each other.

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

/// `int_0^u exp(s z) ds = (exp(u z) - 1) / z`, and its limit `u` at 0.
fn integral(z: DVec2, u: f64) -> DVec2 {
    match z.length_squared() > 1e-24 {
        true => quotient(exp_m1(u * z), z),
        false => DVec2::new(u, 0.0),
    }
}

/// A velocity of a camera in its own space, whose unit is the distance to its target.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Twist {
    /// Growth of the logarithm of the distance.
    growth: f64,
    /// Axis and angle of the turn.
    turn: DVec3,
    /// The move of the eye.
    shift: DVec3,
}

impl Twist {
    fn times(self, factor: f64) -> Self {
        Self {
            growth: factor * self.growth,
            turn: factor * self.turn,
            shift: factor * self.shift,
        }
    }

    /// Multiplies the part of a vector across the turn's axis by a complex number, and the part
    /// along it by a real one.
    fn scale(&self, along: f64, across: DVec2, vector: DVec3) -> DVec3 {
        let axis = self.turn.normalize_or_zero();
        let part = axis * axis.dot(vector);
        let rest = vector - part;
        along * part + across.x * rest + across.y * axis.cross(rest)
    }

    /// The velocity at a pose between the one before and the one after. Zooms about the target are
    /// taken by themselves, so that none goes on into a move that has none.
    fn mean(before: Self, after: Self) -> Self {
        // A zoom about the target (0, 0, -1) moves the eye along the view.
        let split = |twist: Self| (twist.turn, twist.shift - twist.growth * DVec3::Z);
        let (a, b) = (split(before), split(after));
        let size = |(turn, shift): (DVec3, DVec3)| turn.length_squared() + shift.length_squared();
        let (of_a, of_b) = harmonic(size(a).sqrt(), size(b).sqrt());
        let (zoom_a, zoom_b) = harmonic(before.growth.abs(), after.growth.abs());
        let growth = zoom_a * before.growth + zoom_b * after.growth;
        Self {
            growth,
            turn: of_a * a.0 + of_b * b.0,
            shift: of_a * a.1 + of_b * b.1 + growth * DVec3::Z,
        }
    }
}

/// The weights of two velocities of these sizes, both at least 0, in their harmonic mean.
fn harmonic(a: f64, b: f64) -> (f64, f64) {
    match a + b > 0.0 {
        true => (b / (a + b), a / (a + b)),
        false => (0.0, 0.0),
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

    /// The motion to another pose, of the two ways round the short one.
    fn way_to(&self, other: &Self) -> Twist {
        let mut by = self.turn.inverse() * other.turn;
        if by.w < 0.0 {
            by = -by;
        }
        let turn = by.to_scaled_axis();
        let twist = Twist {
            growth: (other.distance / self.distance).ln(),
            turn,
            shift: DVec3::ZERO,
        };
        let way = self.turn.inverse() * (other.eye - self.eye) / self.distance;
        let one = DVec2::new(1.0, 0.0);
        let along = integral(DVec2::new(twist.growth, 0.0), 1.0).x;
        let across = integral(DVec2::new(twist.growth, turn.length()), 1.0);
        let shift = twist.scale(1.0 / along, quotient(one, across), way);
        Twist { shift, ..twist }
    }

    /// The pose after a share of a motion.
    fn along(&self, twist: &Twist, u: f64) -> Self {
        let along = integral(DVec2::new(twist.growth, 0.0), u).x;
        let across = integral(DVec2::new(twist.growth, twist.turn.length()), u);
        let moved = twist.scale(along, across, twist.shift) * self.distance;
        Self {
            eye: self.eye + self.turn * moved,
            turn: (self.turn * DQuat::from_scaled_axis(u * twist.turn)).normalize(),
            distance: self.distance * (u * twist.growth).exp(),
        }
    }

    /// The pose at a share of the way to another: 0 is here, 1 is there; others lie before and
    /// beyond.
    pub fn toward(&self, other: &Self, u: f64) -> Self {
        self.along(&self.way_to(other), u)
    }

    /// The pose at a time between the second and the third of four, on a smooth path through all.
    /// Their times ascend.
    pub fn on_spline(poses: [(f64, Self); 4], at: f64) -> Self {
        let [velocity_before, velocity, velocity_after] = [0, 1, 2].map(|i| {
            let [(from, a), (to, b)] = [poses[i], poses[i + 1]];
            a.way_to(&b).times(1.0 / (to - from))
        });
        let [(from, here), (to, there)] = [poses[1], poses[2]];
        let third = (to - from) / 3.0;
        let first = Twist::mean(velocity_before, velocity).times(third);
        let last = Twist::mean(velocity, velocity_after).times(third);
        let middle = here.along(&first, 1.0).way_to(&there.along(&last, -1.0));
        // The cumulative Bernstein polynomials.
        let u = (at - from) / (to - from);
        let share = [1.0 - (1.0 - u).powi(3), u * u * (3.0 - 2.0 * u), u.powi(3)];
        here.along(&first, share[0])
            .along(&middle, share[1])
            .along(&last, share[2])
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

    #[test]
    fn a_zoom_does_not_go_on_into_a_pan() {
        let from = |d: f64, x: f64| level(DVec3::new(x, -d, 0.0), DVec3::new(x, 0.0, 0.0));
        let poses = [
            (0.0, from(10.0, 0.0)),
            (0.25, from(0.01, 0.0)),
            (5.0, from(0.01, 2.0)),
            (10.0, from(0.01, 2.0)),
        ];
        for i in 0..=20 {
            let at = 0.25 + 4.75 * f64::from(i) / 20.0;
            let there = Pose::on_spline(poses, at);
            assert!((there.distance - 0.01).abs() < 1e-12, "{there:?}");
            assert!((0.0..2.0 + 1e-12).contains(&there.eye.x), "{there:?}");
        }
    }
}
