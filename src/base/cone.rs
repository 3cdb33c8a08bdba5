//! The cone step: how far one empty ball carries a cone's front (docs/method.md, 2).
//!
//! The *front* of a cone is the distance up to which all of its rays are proven to meet
//! nothing. An empty ball about a point of the axis may prove more. The exact rule gives
//! the farthest front that one ball proves, whatever the ball came from. The rule of the
//! 2012 slides is kept for comparison.
//! Twins: `wgsl/base/cone.wgsl` and `wgsl/base/cone_slides.wgsl`.

use crate::base::shader::Module;
use crate::wgsl;

/// Share of a ball's radius that f32 may trust. The whole radius claims progress without
/// `d > k t` in about one of a thousand steps near that limit.
pub const CONE_TRUST: f64 = 1.0 - 1.0 / 1_048_576.0;
/// Factor that keeps a front below the exact one when it is rounded to f32.
pub const CONE_ROUND_DOWN: f64 = 1.0 - 1.0 / 4_194_304.0;

/// The rule that carries a front forward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ConeRule {
    /// The exact step: no ray of the cone can pass a surface.
    #[default]
    Exact,
    /// `t += d` while `d > k t`, as in the 2012 slides. It leaves gaps.
    Slides,
}

impl ConeRule {
    /// The WGSL module of the rule.
    pub fn module(self) -> Module {
        match self {
            Self::Exact => wgsl!(
                "base/cone.wgsl",
                "CONE_TRUST" = CONE_TRUST,
                "CONE_ROUND_DOWN" = CONE_ROUND_DOWN
            ),
            Self::Slides => wgsl!("base/cone_slides.wgsl"),
        }
    }

    /// The new front of a cone of chord `k` from one empty ball of radius `d` about the axis
    /// point at `t`. It is `front` itself if the ball proves nothing.
    pub fn cone_front(self, front: f64, t: f64, d: f64, k: f64) -> f64 {
        match self {
            Self::Exact => exact(front, t, d, k),
            Self::Slides if d <= k * t => front,
            Self::Slides => front.max(t + d),
        }
    }

    /// The same for rays that start within `r0` of the axis in a plane across it, with the chord
    /// `k`, from an empty ball about the axis point at the front `t`.
    ///
    /// A ray is at most `hypot(s - t, r0) + k s` from the middle of the ball at s. This is within
    /// the ball up to `t + sqrt(b^2 - r0^2)`, where b is its radius less `k (t + d)`.
    pub fn cone_parallel(self, t: f64, d: f64, r0: f64, k: f64) -> f64 {
        if self == Self::Slides {
            return self.cone_front(t, t, d - r0, k);
        }
        let ball = d * CONE_TRUST - k * (t + d);
        if ball.is_nan() || ball <= r0 {
            return t;
        }
        let root = ((ball - r0) * (ball + r0)).sqrt();
        t.max((t + root) * CONE_ROUND_DOWN)
    }
}

fn exact(front: f64, t: f64, d: f64, k: f64) -> f64 {
    let ball = d * CONE_TRUST;
    if ball.is_nan() || ball <= 0.0 {
        return front;
    }
    let reach = t * k * (1.0 - 0.25 * k * k).max(0.0).sqrt();
    let q = (ball - reach) * (ball + reach);
    if q < 0.0 {
        return front;
    }
    let middle = t * (1.0 - 0.5 * k * k);
    let root = q.sqrt();
    if middle - root > front {
        return front;
    }
    front.max((middle + root) * CONE_ROUND_DOWN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// Rays at the edge of a bundle are in the ball up to the front, and not much farther.
    #[test]
    fn a_ball_holds_parallel_rays_up_to_the_front() {
        for (t, d, r0) in [(0.0, 1.0, 0.3), (5.0, 2.0, 1.9), (40.0, 0.01, 0.0)] {
            for k in [0.0, 1e-6, 1e-3, 0.02] {
                let front = ConeRule::Exact.cone_parallel(t, d, r0, k);
                let mut most = 0.0_f64;
                for turn in 0..64 {
                    let along =
                        DVec3::from_array([0.0, f64::from(turn).cos(), f64::from(turn).sin()]);
                    // The chord in the plane of the start, and towards the axis.
                    for slope in [-k, 0.0, k] {
                        let axis = DVec3::new(1.0 - 0.5 * k * k, 0.0, 0.0)
                            + slope * (1.0 - 0.25 * k * k).sqrt() * along;
                        for share in [0.0, 0.5, 1.0] {
                            let s = t + share * (front - t);
                            let off = (r0 * along + s * axis).distance(DVec3::X * t);
                            assert!(front == t || off <= d * (1.0 + 1e-12), "{t} {d} {r0} {k}");
                            most = most.max(off / d);
                        }
                    }
                }
                assert!(
                    front == t || k * (t + d) > 1e-4 * d || most > 0.999,
                    "{t} {d} {r0} {k} {most}"
                );
            }
        }
        assert_eq!(ConeRule::Exact.cone_parallel(3.0, 1.0, 1.1, 0.0), 3.0);
    }
}
