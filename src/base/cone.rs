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
