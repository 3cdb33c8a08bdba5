//! What the orbit of a point tells about its distance to a Mandelbox (docs/method.md, 3): an
//! estimate for hits, and the radii of two empty balls for steps.
//! Twin: `wgsl/formula/orbit.wgsl`.

use glam::{DMat3, DVec3};

use crate::formula::contract::{Evaluate, Reading};
use crate::formula::folds::{Fold, Folds};
use crate::formula::rotation::Rotation;

/// Iterations in which the Jacobian is followed. Most of what the scalar factor overstates is in
/// the first terms of its sum.
const PREFIX: u32 = 3;

/// Divisor of the chain where cones go by it.
pub const ROTATED_SLOPE: f64 = 1.25;

/// Radii of balls stay below this, as their squares could overflow in f32.
const MOST_RADIUS: f64 = 1e15;

/// The derivative of a point of the orbit by the starting point, while all folds are linear.
pub trait Jacobian: Copy {
    /// The identity.
    const START: Self;
    /// The next one: a fold that mirrors coordinates where `mirror` is -1, a rotation and a scale,
    /// and the starting point is added.
    fn next(self, mirror: DVec3, rotation: Option<&Rotation>, scale: f64) -> Self;
    /// An upper bound of the operator norm.
    fn norm(self) -> f64;
}

/// Without a rotation it is diagonal.
impl Jacobian for DVec3 {
    const START: Self = DVec3::ONE;

    fn next(self, mirror: DVec3, _: Option<&Rotation>, scale: f64) -> Self {
        scale * mirror * self + DVec3::ONE
    }

    fn norm(self) -> f64 {
        self.abs().max_element()
    }
}

impl Jacobian for DMat3 {
    const START: Self = DMat3::IDENTITY;

    fn next(self, mirror: DVec3, rotation: Option<&Rotation>, scale: f64) -> Self {
        let columns = [self.x_axis, self.y_axis, self.z_axis];
        let turned = columns.map(|v| scale * rotation.map_or(mirror * v, |r| r.rotate(mirror * v)));
        Self::from_cols(turned[0], turned[1], turned[2]) + Self::IDENTITY
    }

    /// The largest eigenvalue of a symmetric 3 x 3 matrix is at most its mean plus sqrt(2/3) times
    /// the Frobenius norm of the matrix less the mean.
    fn norm(self) -> f64 {
        let [x, y, z] = [self.x_axis, self.y_axis, self.z_axis];
        let squares = DVec3::new(x.dot(x), y.dot(y), z.dot(z));
        let products = DVec3::new(x.dot(y), y.dot(z), z.dot(x));
        let mean = squares.element_sum() / 3.0;
        let off = (squares - DVec3::splat(mean)).length_squared() + 2.0 * products.length_squared();
        (mean + (2.0 / 3.0 * off).sqrt()).sqrt()
    }
}

/// The estimates of a Mandelbox that is not in Julia mode.
#[derive(Clone, Debug)]
pub struct Orbits(pub Folds);

/// A ball about the point and what it has spread to in the orbit.
struct Trial {
    trial: f64,
    /// How far the edge of escape may move within the trial ball.
    shift: f64,
    radius: f64,
    /// The largest share of the trial ball that is proven empty.
    share: f64,
}

impl Trial {
    fn test(&mut self, top: f64) {
        self.share = self.share.max(top / (self.radius + self.shift));
    }
}

/// All that an orbit tells.
struct Orbit {
    value: f64,
    chain: f64,
    ball: f64,
    iterations: u32,
}

impl Orbits {
    /// How far the coordinates are beyond the sides of the box fold.
    fn beyond(&self, z: DVec3) -> DVec3 {
        z.abs() - DVec3::splat(self.0.fold_limit)
    }

    /// Whether the factor of the ball fold varies about the point.
    fn inverts(&self, fold: &Fold) -> bool {
        fold.length > self.0.radii[0] && fold.length < self.0.radii[1]
    }

    /// The distance to the nearest place where a fold is not linear.
    fn clearance(&self, z: DVec3, fold: &Fold) -> f64 {
        let sides = self.beyond(z).abs().min_element();
        let [low, high] = self.0.radii.map(|r| (fold.length - r).abs());
        sides.min(low).min(high)
    }

    /// What a ball of a radius about a point spreads to in one iteration.
    fn spread(&self, fold: &Fold, trial: &Trial) -> f64 {
        let [low, high] = self.0.radii;
        let near = (fold.length - trial.radius).clamp(low, high);
        let growth = high * high / (fold.length.clamp(low, high) * near);
        (self.0.scale.abs() * growth * trial.radius + trial.trial).min(MOST_RADIUS)
    }

    /// Follows the orbit of a point. What the caller does not read is not computed.
    #[inline(always)]
    fn orbit<J: Jacobian>(&self, p: DVec3, most: u32, clear: f64, trial: f64) -> Orbit {
        let exit = self.0.exit(p);
        let (mut z, mut n) = (p, 0);
        // W(k): the growth, if the Jacobian is followed for k iterations, and the radius of the
        // ball in which these are linear.
        let (mut w, mut room) = ([1.0_f64; 4], [f64::INFINITY; 4]);
        let (mut jacobian, mut norm, mut free) = (J::START, 1.0_f64, f64::INFINITY);
        let mut ball = Trial {
            trial,
            shift: self.0.kappa.abs() * trial,
            radius: trial,
            share: 0.0,
        };
        ball.test(self.0.top(z, p));
        while n < most.min(PREFIX) && !self.0.ended(z, exit) {
            let fold = self.0.fold(z);
            if self.inverts(&fold) {
                break;
            }
            free = free.min(self.clearance(z, &fold) / norm);
            let mirror = DVec3::select(
                self.beyond(z).cmpgt(DVec3::ZERO),
                DVec3::NEG_ONE,
                DVec3::ONE,
            );
            jacobian = jacobian.next(mirror, self.0.rotation.as_ref(), self.0.scale * fold.m);
            norm = jacobian.norm();
            ball.radius = match free >= trial {
                true => norm * trial,
                false => self.spread(&fold, &ball),
            };
            let growth = self.0.growth(&fold);
            w = std::array::from_fn(|k| match k as u32 <= n {
                true => growth * w[k] + 1.0,
                false => norm,
            });
            room = std::array::from_fn(|k| if k as u32 <= n { room[k] } else { free });
            z = self.0.next(&fold, p);
            n += 1;
            ball.test(self.0.top(z, p));
        }
        let (mut product, mut sum) = (1.0, 0.0);
        while n < most && !self.0.ended(z, exit) {
            let fold = self.0.fold(z);
            ball.radius = self.spread(&fold, &ball);
            let growth = self.0.growth(&fold);
            // Kept finite. The estimate is zero in f64 long before this limit.
            (product, sum) = (
                (growth * product).min(1e300),
                (growth * sum + 1.0).min(1e300),
            );
            z = self.0.next(&fold, p);
            n += 1;
            ball.test(self.0.top(z, p));
        }
        let top = self.0.past(z, p, exit);
        let estimates = w.map(|w| top / (product * w + sum + self.0.tail));
        // At negative scales the Jacobian has next to no slack.
        let last = if self.0.scale > 0.0 { 3 } else { 0 };
        let step = |k: usize| ((estimates[k] - clear) / self.0.lipschitz).min(room[k]);
        Orbit {
            value: estimates[last],
            chain: (0..=last).map(step).fold(f64::NEG_INFINITY, f64::max),
            ball: trial * ball.share.min(1.0),
            iterations: n,
        }
    }

    #[inline(always)]
    fn follow(&self, p: DVec3, most: u32, clear: f64, trial: f64) -> Orbit {
        match self.0.rotation {
            None => self.orbit::<DVec3>(p, most, clear, trial),
            Some(_) => self.orbit::<DMat3>(p, most, clear, trial),
        }
    }
}

impl Evaluate for Orbits {
    fn value(&self, p: DVec3, most: u32) -> (f64, u32) {
        let orbit = self.follow(p, most, 0.0, 1.0);
        (orbit.value, orbit.iterations)
    }

    fn step(&self, p: DVec3, most: u32, clear: f64) -> Reading {
        let orbit = self.follow(p, most, clear, 1.0);
        Reading {
            value: orbit.value,
            radius: orbit.chain,
            iterations: orbit.iterations,
        }
    }

    /// With a rotation the proven balls are so small that cones do not pay.
    fn cone(&self, p: DVec3, most: u32, trial: f64) -> Reading {
        match self.0.rotation {
            None => self.ball(p, most, trial),
            Some(_) => {
                let step = self.step(p, most, 0.0);
                Reading {
                    radius: step.radius / ROTATED_SLOPE,
                    ..step
                }
            }
        }
    }

    fn ball(&self, p: DVec3, most: u32, trial: f64) -> Reading {
        let orbit = self.follow(p, most, 0.0, trial);
        Reading {
            value: orbit.value,
            radius: orbit.ball,
            iterations: orbit.iterations,
        }
    }
}
