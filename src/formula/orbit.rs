//! What the orbit of a point tells about its distance to a Mandelbox (docs/method.md, 3): an
//! estimate for hits, and the radii of two empty balls for steps.
//! Twin: `wgsl/formula/orbit.wgsl`.

use fearless_simd::dispatch;
use glam::{DMat3, DVec3};

use crate::base::lanes::{LANES, Places, Triples, level};
use crate::formula::contract::{Evaluate, Reading};
use crate::formula::folds::{Fold, Folds};
use crate::formula::rotation::Rotation;

/// Iterations in which the Jacobian is followed. Most of what the scalar factor overstates is in
/// the first terms of its sum.
pub(super) const PREFIX: u32 = 3;

/// Divisor of the chain where cones go by it.
pub const ROTATED_SLOPE: f64 = 1.25;

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

/// How distances grow along an orbit. As long as all folds are linear, the Jacobian tells.
#[derive(Clone, Copy)]
struct Growth<J> {
    jacobian: J,
    /// Its norm.
    norm: f64,
    /// The growth factor for all directions.
    scalar: f64,
    /// The radius of a ball about the starting point in which the folds are linear.
    free: f64,
    /// What later iterations do to a growth factor w: it becomes `product w + sum`.
    product: f64,
    sum: f64,
}

impl<J: Jacobian> Growth<J> {
    const START: Self = Self {
        jacobian: J::START,
        norm: 1.0,
        scalar: 1.0,
        free: f64::INFINITY,
        product: 1.0,
        sum: 0.0,
    };

    /// Goes on by an iteration of any kind.
    fn grow(&mut self, growth: f64) {
        // Kept finite. The estimate is zero in f64 long before this limit.
        self.product = (growth * self.product).min(1e300);
        self.sum = (growth * self.sum + 1.0).min(1e300);
    }
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

    /// Goes on by one iteration from z.
    fn follow<J: Jacobian>(&self, grown: &mut Growth<J>, z: DVec3, fold: &Fold) {
        let Self(folds) = self;
        grown.free = grown.free.min(self.clearance(z, fold) / grown.norm);
        let mirrored = self.beyond(z).cmpgt(DVec3::ZERO);
        let mirror = DVec3::select(mirrored, DVec3::NEG_ONE, DVec3::ONE);
        let rotation = folds.rotation.as_ref();
        grown.jacobian = grown.jacobian.next(mirror, rotation, folds.scale * fold.m);
        grown.norm = grown.jacobian.norm();
        grown.scalar = folds.growth(fold) * grown.scalar + 1.0;
    }

    /// What a ball of a radius about a point spreads to in one iteration; `trial` is the radius
    /// that it started with.
    fn spread(&self, fold: &Fold, radius: f64, trial: f64) -> f64 {
        let [low, high] = self.0.radii;
        let near = (fold.length - radius).clamp(low, high);
        let growth = high * high / (fold.length.clamp(low, high) * near);
        self.0.scale.abs() * growth * radius + trial
    }

    /// The estimate at the end of an orbit, with the norm of the Jacobian, and with one growth
    /// factor for all directions. At negative scales the Jacobian has next to no slack.
    fn estimates<J>(&self, past: f64, grown: &Growth<J>) -> [f64; 2] {
        let sharp = if self.0.scale > 0.0 {
            grown.norm
        } else {
            grown.scalar
        };
        let end = |w| grown.product * w + grown.sum + self.0.tail;
        [sharp, grown.scalar].map(|w| past / end(w))
    }

    /// The estimate, and a radius for steps of rays: the largest for which the folds are linear in no
    /// iteration, in the first one, or in all of the prefix.
    #[inline(always)]
    fn chain<J: Jacobian>(&self, p: DVec3, most: u32, clear: f64) -> Reading {
        let Self(folds) = self;
        let exit = folds.exit(p);
        let (mut z, mut n) = (p, 0);
        let mut grown = Growth::<J>::START;
        // The growth factor with the norm after the first iteration, and the radius in which that is
        // linear.
        let (mut middle, mut free) = (grown.norm, grown.free);
        // Where the Jacobian is not used, it is not followed.
        let prefix = if folds.scale > 0.0 { PREFIX } else { 0 };
        while n < most.min(prefix) && !folds.ended(z, exit) {
            let fold = folds.fold(z);
            if self.inverts(&fold) {
                break;
            }
            self.follow(&mut grown, z, &fold);
            (middle, free) = match n {
                0 => (grown.norm, grown.free),
                _ => (folds.growth(&fold) * middle + 1.0, free),
            };
            z = folds.next(&fold, p);
            n += 1;
        }
        while n < most && !folds.ended(z, exit) {
            let fold = folds.fold(z);
            grown.grow(folds.growth(&fold));
            z = folds.next(&fold, p);
            n += 1;
        }
        let past = folds.top(z, p);
        let [sharp, scalar] = self.estimates(past, &grown);
        let between = past / (grown.product * middle + grown.sum + folds.tail);
        let [long, between, short] =
            [sharp, between, scalar].map(|e| (e - clear) / folds.lipschitz);
        Reading {
            value: sharp,
            radius: short.max(between.min(free)).max(long.min(grown.free)),
            iterations: n,
        }
    }

    /// The estimate, and the radius of an empty ball: the largest part of a trial ball for which
    /// some iteration shows that all of it escapes.
    #[inline(always)]
    fn trial_ball<J: Jacobian>(&self, p: DVec3, most: u32, trial: f64) -> Reading {
        let Self(folds) = self;
        let exit = folds.exit(p);
        let (mut z, mut n) = (p, 0);
        let (mut grown, mut follows) = (Growth::<J>::START, true);
        let mut radius = trial;
        // By so much the place where orbits escape differs within the trial ball.
        let shift = trial
            * folds
                .rotation
                .as_ref()
                .map_or(folds.kappa.abs(), |_| folds.tail);
        let share = |z, radius: f64| folds.top(z, p) / (radius + shift);
        let mut best = share(z, radius);
        while n < most && !folds.ended(z, exit) {
            let fold = folds.fold(z);
            follows &= n < PREFIX && !self.inverts(&fold);
            if follows {
                self.follow(&mut grown, z, &fold);
            } else {
                grown.grow(folds.growth(&fold));
            }
            // As long as the trial ball meets no fold, its image is an ellipsoid.
            radius = match follows && grown.free >= trial {
                true => grown.norm * trial,
                false => self.spread(&fold, radius, trial),
            };
            z = folds.next(&fold, p);
            n += 1;
            best = best.max(share(z, radius));
        }
        Reading {
            value: self.estimates(folds.top(z, p), &grown)[0],
            radius: trial * best.min(1.0),
            iterations: n,
        }
    }
}

/// The ball of a cone from that of a ray.
fn shortened(step: Reading) -> Reading {
    Reading {
        radius: step.radius / ROTATED_SLOPE,
        ..step
    }
}

impl Evaluate for Orbits {
    fn value(&self, p: DVec3, most: u32) -> (f64, u32) {
        let all = self.step(p, most, 0.0);
        (all.value, all.iterations)
    }

    fn lipschitz(&self) -> f64 {
        self.0.lipschitz
    }

    fn step(&self, p: DVec3, most: u32, clear: f64) -> Reading {
        match self.0.rotation {
            None => self.chain::<DVec3>(p, most, clear),
            Some(_) => self.chain::<DMat3>(p, most, clear),
        }
    }

    /// With a rotation the proven balls are so small that cones do not pay.
    fn cone(&self, p: DVec3, most: u32, trial: f64) -> Reading {
        match self.0.rotation {
            None => self.ball(p, most, trial),
            Some(_) => shortened(self.step(p, most, 0.0)),
        }
    }

    fn ball(&self, p: DVec3, most: u32, trial: f64) -> Reading {
        match self.0.rotation {
            None => self.trial_ball::<DVec3>(p, most, trial),
            Some(_) => self.trial_ball::<DMat3>(p, most, trial),
        }
    }

    fn trap(&self, p: DVec3, most: u32) -> DVec3 {
        self.0.trap(p, p, most)
    }

    fn traps(&self, p: DVec3, most: u32) -> [f64; 7] {
        self.0.traps(p, p, most)
    }

    fn trap_lanes(&self, at: &Places, most: u32) -> [DVec3; LANES] {
        dispatch!(level(), simd => self.0.trap_lanes(simd, at, None, most))
    }

    fn has_lanes(&self) -> bool {
        true
    }

    fn values(&self, at: &Places, most: u32) -> [f64; LANES] {
        self.steps(at, most, &[0.0; LANES]).map(|all| all.value)
    }

    fn steps(&self, at: &Places, most: u32, clear: &[f64; LANES]) -> [Reading; LANES] {
        match self.0.rotation {
            None => {
                dispatch!(level(), simd => self.chain_lanes::<_, Triples<_>>(simd, at, most, clear))
            }
            Some(_) => {
                dispatch!(level(), simd => self.chain_lanes::<_, [Triples<_>; 3]>(simd, at, most, clear))
            }
        }
    }

    fn cones(&self, at: &Places, most: u32, trial: &[f64; LANES]) -> [Reading; LANES] {
        match self.0.rotation {
            None => self.balls(at, most, trial),
            Some(_) => self.steps(at, most, &[0.0; LANES]).map(shortened),
        }
    }

    fn balls(&self, at: &Places, most: u32, trial: &[f64; LANES]) -> [Reading; LANES] {
        match self.0.rotation {
            None => {
                dispatch!(level(), simd => self.trial_ball_lanes::<_, Triples<_>>(simd, at, most, trial))
            }
            Some(_) => {
                dispatch!(level(), simd => self.trial_ball_lanes::<_, [Triples<_>; 3]>(simd, at, most, trial))
            }
        }
    }
}
