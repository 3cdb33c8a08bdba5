//! The estimates of [`Orbits`] for several points side by side, with the bits of those for one.

use fearless_simd::prelude::*;

use crate::base::lanes::{LANES, Mask, Places, Reals, Triples, mask};
use crate::formula::contract::Reading;
use crate::formula::folds::Folds;
use crate::formula::folds_lanes::FoldLanes;
use crate::formula::orbit::{Orbits, PREFIX};

/// The derivatives of the lanes; see [`crate::formula::orbit::Jacobian`].
pub trait Jacobians<S: Simd>: Copy {
    /// Identities.
    fn start(simd: S) -> Self;
    /// The next ones.
    fn next(self, folds: &Folds, mirror: Triples<S>, scale: Reals<S>) -> Self;
    /// Upper bounds of the operator norms.
    fn norm(self) -> Reals<S>;
    /// A choice for each lane.
    fn select(on: Mask<S>, yes: Self, no: Self) -> Self;
}

/// Without a rotation they are diagonal.
impl<S: Simd> Jacobians<S> for Triples<S> {
    #[inline(always)]
    fn start(simd: S) -> Self {
        Triples::all(simd, glam::DVec3::ONE)
    }

    #[inline(always)]
    fn next(self, _: &Folds, mirror: Triples<S>, scale: Reals<S>) -> Self {
        (mirror * scale).times(self) + Self::start(scale.simd)
    }

    #[inline(always)]
    fn norm(self) -> Reals<S> {
        self.abs().max_element()
    }

    #[inline(always)]
    fn select(on: Mask<S>, yes: Self, no: Self) -> Self {
        Triples::select(on, yes, no)
    }
}

/// Columns.
impl<S: Simd> Jacobians<S> for [Triples<S>; 3] {
    #[inline(always)]
    fn start(simd: S) -> Self {
        glam::DMat3::IDENTITY
            .to_cols_array_2d()
            .map(|v| Triples::all(simd, v.into()))
    }

    #[inline(always)]
    fn next(self, folds: &Folds, mirror: Triples<S>, scale: Reals<S>) -> Self {
        let [x, y, z] = self;
        let [i, j, k] = Self::start(scale.simd);
        [
            folds.turn_lanes(mirror.times(x)) * scale + i,
            folds.turn_lanes(mirror.times(y)) * scale + j,
            folds.turn_lanes(mirror.times(z)) * scale + k,
        ]
    }

    #[inline(always)]
    fn norm(self) -> Reals<S> {
        let [x, y, z] = self;
        let squares = Triples {
            x: x.dot(x),
            y: y.dot(y),
            z: z.dot(z),
        };
        let products = Triples {
            x: x.dot(y),
            y: y.dot(z),
            z: z.dot(x),
        };
        let mean = (squares.x + squares.y + squares.z) / 3.0;
        let off = squares - mean;
        let off = off.dot(off) + products.dot(products) * 2.0;
        (mean + (off * (2.0 / 3.0)).sqrt()).sqrt()
    }

    #[inline(always)]
    fn select(on: Mask<S>, yes: Self, no: Self) -> Self {
        [
            Triples::select(on, yes[0], no[0]),
            Triples::select(on, yes[1], no[1]),
            Triples::select(on, yes[2], no[2]),
        ]
    }
}

/// See `Growth` of `orbit`.
#[derive(Clone, Copy)]
struct Growths<S: Simd, J> {
    jacobian: J,
    norm: Reals<S>,
    scalar: Reals<S>,
    free: Reals<S>,
    product: Reals<S>,
    sum: Reals<S>,
}

impl<S: Simd, J: Jacobians<S>> Growths<S, J> {
    #[inline(always)]
    fn start(simd: S) -> Self {
        let all = |x| Reals::splat(simd, x);
        Self {
            jacobian: J::start(simd),
            norm: all(1.0),
            scalar: all(1.0),
            free: all(f64::INFINITY),
            product: all(1.0),
            sum: all(0.0),
        }
    }

    /// Goes on by an iteration of any kind in some lanes.
    #[inline(always)]
    fn grow(&mut self, on: Mask<S>, growth: Reals<S>) {
        self.product = on.select((growth * self.product).min(1e300), self.product);
        self.sum = on.select((growth * self.sum + 1.0).min(1e300), self.sum);
    }
}

impl Orbits {
    /// Where the factor of the ball fold varies about the point.
    #[inline(always)]
    fn inverts_lanes<S: Simd>(&self, length: Reals<S>) -> Mask<S> {
        length.simd_gt(self.0.radii[0]) & length.simd_lt(self.0.radii[1])
    }

    /// Goes on by one iteration from z in some lanes.
    #[inline(always)]
    fn follow_lanes<S: Simd, J: Jacobians<S>>(
        &self,
        on: Mask<S>,
        grown: &mut Growths<S, J>,
        z: Triples<S>,
        fold: &FoldLanes<S>,
    ) {
        let Self(folds) = self;
        let simd = z.x.simd;
        let beyond = z.abs() - Reals::splat(simd, folds.fold_limit);
        let length = fold.length();
        let [low, high] = folds.radii;
        let sides = beyond.abs().min_element();
        let clearance = sides.min((length - low).abs()).min((length - high).abs());
        let free = grown.free.min(clearance / grown.norm);
        let (minus, plus) = (Reals::splat(simd, -1.0), Reals::splat(simd, 1.0));
        let mirror = Triples {
            x: beyond.x.simd_gt(0.0).select(minus, plus),
            y: beyond.y.simd_gt(0.0).select(minus, plus),
            z: beyond.z.simd_gt(0.0).select(minus, plus),
        };
        let jacobian = grown.jacobian.next(folds, mirror, fold.m * folds.scale);
        let scalar = folds.growth_lanes(fold) * grown.scalar + 1.0;
        grown.free = on.select(free, grown.free);
        grown.jacobian = J::select(on, jacobian, grown.jacobian);
        grown.norm = on.select(jacobian.norm(), grown.norm);
        grown.scalar = on.select(scalar, grown.scalar);
    }

    /// See `Orbits::estimates`.
    #[inline(always)]
    fn estimates_lanes<S: Simd, J>(&self, past: Reals<S>, grown: &Growths<S, J>) -> [Reals<S>; 2] {
        let scalar = past / (grown.product * grown.scalar + grown.sum + self.0.tail);
        let sharp = match self.0.scale > 0.0 {
            true => past / (grown.product * grown.norm + grown.sum + self.0.tail),
            false => scalar,
        };
        [sharp, scalar]
    }

    /// See `Orbits::chain`.
    #[inline(always)]
    pub(super) fn chain_lanes<S: Simd, J: Jacobians<S>>(
        &self,
        simd: S,
        at: &Places,
        most: u32,
        clear: &[f64; LANES],
    ) -> [Reading; LANES] {
        let Self(folds) = self;
        let p = Triples::of(simd, &at.points);
        let mut on = mask(simd, &at.on);
        let exit = folds.exit_lanes(p);
        let (one, none) = (Reals::splat(simd, 1.0), Reals::splat(simd, 0.0));
        let (mut z, mut n) = (p, none);
        let mut grown = Growths::<S, J>::start(simd);
        let (mut middle, mut free) = (grown.norm, grown.free);
        let prefix = if folds.scale > 0.0 { PREFIX } else { 0 };
        let mut follows = on;
        for i in 0..most {
            on &= !folds.ended_lanes(z, exit);
            if on.all_false() {
                break;
            }
            let fold = folds.fold_lanes(z);
            let mut grows = on;
            if i < prefix {
                follows &= on & !self.inverts_lanes(fold.length());
                if follows.any_true() {
                    self.follow_lanes(follows, &mut grown, z, &fold);
                    grows &= !follows;
                    let further = folds.growth_lanes(&fold) * middle + 1.0;
                    let first = i == 0;
                    middle = follows.select(if first { grown.norm } else { further }, middle);
                    free = if first { grown.free } else { free };
                }
            }
            grown.grow(grows, folds.growth_lanes(&fold));
            z = Triples::select(on, folds.next_lanes(&fold, p), z);
            n += on.select(one, none);
        }
        let past = folds.top_lanes(z, p);
        let [sharp, scalar] = self.estimates_lanes(past, &grown);
        let between = past / (grown.product * middle + grown.sum + folds.tail);
        let clear = Reals::simd_from(simd, *clear);
        let step = |estimate: Reals<S>| (estimate - clear) / folds.lipschitz;
        let (long, short) = (step(sharp).min(grown.free), step(scalar));
        readings(sharp, short.max(step(between).min(free)).max(long), n)
    }

    /// See `Orbits::spread`.
    #[inline(always)]
    fn spread_lanes<S: Simd>(
        &self,
        length: Reals<S>,
        radius: Reals<S>,
        trial: Reals<S>,
    ) -> Reals<S> {
        let [low, high] = self.0.radii;
        let near = (length - radius).max(low).min(high);
        let growth = high * high / (length.max(low).min(high) * near);
        growth * self.0.scale.abs() * radius + trial
    }

    /// See `Orbits::trial_ball`.
    #[inline(always)]
    pub(super) fn trial_ball_lanes<S: Simd, J: Jacobians<S>>(
        &self,
        simd: S,
        at: &Places,
        most: u32,
        trial: &[f64; LANES],
    ) -> [Reading; LANES] {
        let Self(folds) = self;
        let p = Triples::of(simd, &at.points);
        let trial = Reals::simd_from(simd, *trial);
        let mut on = mask(simd, &at.on);
        let exit = folds.exit_lanes(p);
        let (one, none) = (Reals::splat(simd, 1.0), Reals::splat(simd, 0.0));
        let (mut z, mut n) = (p, none);
        let mut grown = Growths::<S, J>::start(simd);
        let mut follows = on;
        let mut radius = trial;
        let rotation = folds.rotation.as_ref();
        let shift = trial * rotation.map_or(folds.kappa.abs(), |_| folds.tail);
        let mut best = folds.top_lanes(z, p) / (radius + shift);
        for i in 0..most {
            on &= !folds.ended_lanes(z, exit);
            if on.all_false() {
                break;
            }
            let fold = folds.fold_lanes(z);
            let length = fold.length();
            radius = self.spread_lanes(length, radius, trial);
            let mut grows = on;
            if i < PREFIX {
                follows &= on & !self.inverts_lanes(length);
                self.follow_lanes(follows, &mut grown, z, &fold);
                grows &= !follows;
                let whole = follows & grown.free.simd_ge(trial);
                radius = whole.select(grown.norm * trial, radius);
            }
            grown.grow(grows, folds.growth_lanes(&fold));
            z = Triples::select(on, folds.next_lanes(&fold, p), z);
            n += on.select(one, none);
            let share = folds.top_lanes(z, p) / (radius + shift);
            best = on.select(best.max(share), best);
        }
        let [sharp, _] = self.estimates_lanes(folds.top_lanes(z, p), &grown);
        readings(sharp, trial * best.min(1.0), n)
    }
}

/// What the lanes tell.
#[inline(always)]
pub fn readings<S: Simd>(
    value: Reals<S>,
    radius: Reals<S>,
    iterations: Reals<S>,
) -> [Reading; LANES] {
    let (value, radius): ([f64; LANES], [f64; LANES]) = (value.into(), radius.into());
    let iterations: [f64; LANES] = iterations.into();
    std::array::from_fn(|i| Reading {
        value: value[i],
        radius: radius[i],
        iterations: iterations[i] as u32,
    })
}
