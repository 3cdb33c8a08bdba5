//! Steps of cones and rays of a [`Distance`]: what is asked of the estimate, and what follows from the
//! answer.

use glam::DVec3;

use crate::base::outcome::Counts;
use crate::base::view::Beam;
use crate::formula::Reading;
use crate::scene::contract::{Advance, Step};
use crate::scene::distance::Distance;
use crate::scene::stepping::Relaxation;

/// A cone that gains less than this share of its ball stops and leaves the rest to its four
/// children. With a small share, cones creep along surfaces that they graze and pass places
/// that rays would hit. At 0.3 some pixels start behind the surface, at 0.8 none does on the
/// five bench presets.
pub(super) const DISTANCE_ENOUGH: f64 = 0.8;
/// The ball that is tried, in radii of the last one. From 1.25 to 1.7 this makes no difference.
pub(super) const DISTANCE_TRIAL: f64 = 1.5;
/// The least step of a ray, in hit thresholds.
pub(super) const DISTANCE_LEAST: f64 = 0.1;
/// Weight of the newest slope in the automatic relaxation.
pub(super) const DISTANCE_SMOOTHING: f64 = 0.3;
/// The longest automatic step, in radii of the last ball.
pub(super) const DISTANCE_MOST_RELAXED: f64 = 3.0;

/// The state of a ray between two steps.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// The last accepted point.
    pub(super) t: f64,
    /// Radius of the empty ball there.
    pub(super) radius: f64,
    /// Length of the next step.
    pub(super) pace: f64,
    /// The smoothed slope of the radius.
    pub(super) slope: f64,
    /// The value of the field there: a smooth guess of the free room.
    pub(super) room: f64,
    /// Where the ray ends.
    pub(super) end: f64,
}

/// The front of a cone.
#[derive(Clone, Copy)]
pub(super) struct Near {
    pub(super) q: DVec3,
    /// The distance that it keeps from the surface.
    pub(super) shell: f64,
    /// The room up to the bounds.
    pub(super) free: f64,
    /// The ball that is tried; `None` where the bounds are far.
    pub(super) trial: Option<f64>,
}

/// A point that a ray comes to.
#[derive(Clone, Copy)]
pub(super) struct Ahead {
    /// Its distance.
    pub(super) t: f64,
    pub(super) q: DVec3,
    /// The hit threshold there.
    pub(super) eps: f64,
    /// By how much the step keeps clear.
    pub(super) clear: f64,
    /// The ball that is tried.
    pub(super) trial: f64,
}

impl Distance {
    /// What is known about the front of a cone without a ball.
    pub(super) fn near(&self, cone: &Beam, at: Advance) -> Near {
        let t = at.front;
        let q = cone.at(t);
        let eps = self.threshold(cone, t);
        let shell = self.stepping.shell * eps;
        let free = self.bounds.distance(self.eye + q) - cone.r0 - shell;
        // How wide the cone is.
        let wide = if cone.grain == 0.0 {
            cone.r0
        } else {
            cone.k * t
        };
        // Far from the bounds their distance is enough.
        let trial = (free <= 2.0 * wide).then(|| {
            let trial = if at.radius > 0.0 {
                DISTANCE_TRIAL * at.radius
            } else if t > 0.0 {
                4.0 * wide
            } else {
                self.first_trial
            };
            trial + 2.0 * eps + cone.r0
        });
        Near {
            q,
            shell,
            free,
            trial,
        }
    }

    /// Advances a cone by the ball at its front.
    pub(super) fn advance_by(
        &self,
        cone: &Beam,
        at: Advance,
        near: &Near,
        ball: Option<Reading>,
        work: &mut Counts,
    ) -> Advance {
        let (t, mut d) = (at.front, near.free);
        if let Some(ball) = ball {
            work.evaluations += 1;
            work.iterations += ball.iterations;
            d = d.max(ball.radius - near.shell - cone.r0);
        }
        let front = self.stepping.rule.cone_front(t, t, d, cone.k);
        let (front, ball) = match cone.grain == 0.0 {
            true => {
                let (ball, rule) = (d + cone.r0, self.stepping.rule);
                (rule.cone_parallel(t, ball, cone.r0, cone.k), ball)
            }
            false => (front, d),
        };
        Advance {
            front,
            radius: d.max(0.0),
            // After a short gain, or without a ball, the four thinner children go on.
            going: front - t > DISTANCE_ENOUGH * ball.max(0.0),
        }
    }

    /// The next point of a ray; `None` if it is past its end.
    pub(super) fn ahead(&self, ray: &Beam, w: &Walk) -> Option<Ahead> {
        if w.t + w.radius > w.end {
            return None;
        }
        let t = (w.t + w.pace).min(w.end);
        let eps = self.threshold(ray, t);
        // A ray from an eye within the bounds has no ball and no threshold there. The field tells enough.
        let trial = match w.radius == 0.0 {
            true => w.room,
            false => DISTANCE_TRIAL * w.radius,
        };
        Some(Ahead {
            t,
            q: ray.at(t),
            eps,
            clear: self.stepping.shell * eps,
            trial: trial + 2.0 * eps,
        })
    }

    /// Goes on to the next point, where the field is known.
    pub(super) fn go_on(
        &self,
        ray: &Beam,
        walk: &mut Walk,
        ahead: &Ahead,
        (value, ball): (f64, f64),
    ) -> Step {
        let (w, &Ahead { t, eps, clear, .. }) = (*walk, ahead);
        let gone = t - w.t;
        // Near a fold the ball may be tiny, and rays would creep.
        let least = match self.stepping.proven {
            true => (ball + clear).min(DISTANCE_LEAST * eps),
            false => DISTANCE_LEAST * eps,
        };
        let radius = ball.max(least) * self.stepping.stride;
        // Only a stretched step can leave a gap. Any other difference is rounding.
        if w.pace > w.radius && gone > w.radius + radius.max(0.0) {
            walk.pace = w.radius;
            walk.slope = -1.0;
            return Step::Moving;
        }
        walk.t = t;
        if value <= eps {
            // Where the field meets the threshold, by its last two values. So a hit depends little on
            // where the ray's points are.
            let above = w.room - self.threshold(ray, w.t);
            if above > 0.0 {
                walk.t = w.t + gone * (above / (above + (eps - value)));
            }
            return Step::Hit;
        }
        let factor = match self.stepping.relaxation {
            Relaxation::Off => 1.0,
            Relaxation::Factor(f) => f,
            Relaxation::Auto => {
                if gone > 0.0 && w.radius > 0.0 {
                    let slope = (radius - w.radius) / gone;
                    walk.slope += DISTANCE_SMOOTHING * (slope - walk.slope);
                }
                (2.0 / (1.0 - walk.slope).max(1e-3)).clamp(1.0, DISTANCE_MOST_RELAXED)
            }
        };
        walk.radius = radius;
        walk.room = value;
        walk.pace = radius * factor;
        Step::Moving
    }
}
