//! The Mandelbox in Julia mode: every iteration adds the same constant (docs/method.md, 3).
//! Twin: `wgsl/formula/julia.wgsl`.

use fearless_simd::dispatch;
use fearless_simd::prelude::*;
use glam::DVec3;

use crate::base::lanes::{LANES, Places, Reals, Triples, level, mask};
use crate::formula::contract::{Evaluate, Reading};
use crate::formula::folds::Folds;
use crate::formula::orbit_lanes::readings;

/// The estimates of a Mandelbox in Julia mode.
#[derive(Clone, Debug)]
pub struct Julia(pub Folds);

impl Julia {
    /// A lower bound of the distance from a point of the orbit to the set.
    fn outside(&self, z: DVec3) -> f64 {
        let Self(folds) = self;
        match folds.rotation {
            None => {
                let half = DVec3::splat(folds.lead) + folds.tail * folds.julia.abs();
                let beside = (z.abs() - half).max(DVec3::ZERO).length();
                beside.max(z.abs().max_element() - folds.edges(folds.julia)[1])
            }
            Some(_) => (z.length() - folds.k(folds.julia)).max(0.0),
        }
    }

    /// The estimate, a radius that is proven empty, and the number of iterations.
    #[inline(always)]
    fn follow(&self, p: DVec3, most: u32, trial: f64) -> Reading {
        let Self(folds) = self;
        let c = folds.julia;
        let exit = folds.exit(c);
        let (mut z, mut w, mut n) = (p, 1.0_f64, 0);
        // A ball of radius d about z, pulled back to the start, has the radius 1/(bend + w/d), if
        // that is no more than the trial.
        let mut bend = 0.0_f64;
        let [low, high] = folds.radii;
        while n < most && !folds.ended(z, exit) {
            let fold = folds.fold(z);
            // Within the inner radius, the ball fold only scales.
            if fold.length >= low {
                // Outside the fixed sphere, it bends only what the trial ball has inside. 1/inverse is
                // the radius of the trial ball here, which the fold spreads to 1/spread at most.
                let inverse = ((1.0 / trial - bend) / w).max(0.0);
                let spread = (fold.length * inverse - 1.0).max(0.0) / high;
                let inside = 1.0 - (fold.length - high).max(0.0) * spread;
                bend += w * inside.max(0.0) / fold.length;
            }
            // Kept finite. The estimate is zero in f64 long before this limit.
            w = (folds.growth(&fold) * w).min(1e300);
            z = folds.next(&fold, c);
            n += 1;
        }
        // Before an orbit has escaped for good, one large coordinate proves nothing.
        let top = match folds.ended(z, exit) {
            true => folds.top(z, c),
            false => z.length() - folds.k(c),
        };
        let outside = self.outside(z);
        Reading {
            value: top / w,
            radius: trial.min(outside / (bend * outside + w)),
            iterations: n,
        }
    }
}

impl Julia {
    /// See [`Self::outside`].
    #[inline(always)]
    fn outside_lanes<S: Simd>(&self, z: Triples<S>) -> Reals<S> {
        let Self(folds) = self;
        match folds.rotation {
            None => {
                let half = DVec3::splat(folds.lead) + folds.tail * folds.julia.abs();
                let beside = z.abs() - Triples::all(z.x.simd, half);
                let beyond = z.abs().max_element() - folds.edges(folds.julia)[1];
                beside.max(0.0).length().max(beyond)
            }
            Some(_) => (z.length() - folds.k(folds.julia)).max(0.0),
        }
    }

    /// See [`Self::follow`]. Without trials the radii are meaningless.
    #[inline(always)]
    fn follow_lanes<S: Simd>(
        &self,
        simd: S,
        at: &Places,
        most: u32,
        trial: Option<&[f64; LANES]>,
    ) -> [Reading; LANES] {
        let Self(folds) = self;
        let all = |x| Reals::splat(simd, x);
        let c = Triples::all(simd, folds.julia);
        let exit = all(folds.exit(folds.julia));
        let (one, none) = (all(1.0), all(0.0));
        let (mut z, mut w, mut n) = (Triples::of(simd, &at.points), one, none);
        let trial = trial.map(|trial| Reals::simd_from(simd, *trial));
        let mut bend = none;
        let [low, high] = folds.radii;
        let mut on = mask(simd, &at.on);
        for _ in 0..most {
            on &= !folds.ended_lanes(z, exit);
            if on.all_false() {
                break;
            }
            let fold = folds.fold_lanes(z);
            if let Some(trial) = trial {
                let length = fold.length();
                let inverse = ((one / trial - bend) / w).max(0.0);
                let spread = (length * inverse - one).max(0.0) / all(high);
                let inside = one - (length - high).max(0.0) * spread;
                let bent = bend + w * inside.max(0.0) / length;
                bend = (on & length.simd_ge(low)).select(bent, bend);
            }
            w = on.select((folds.growth_lanes(&fold) * w).min(1e300), w);
            z = Triples::select(on, folds.next_lanes(&fold, c), z);
            n += on.select(one, none);
        }
        let near = z.length() - folds.k(folds.julia);
        let ended = folds.ended_lanes(z, exit);
        let top = ended.select(folds.top_lanes(z, c), near);
        let radius = trial.map_or(w, |trial| {
            let outside = self.outside_lanes(z);
            trial.min(outside / (bend * outside + w))
        });
        readings(top / w, radius, n)
    }
}

impl Evaluate for Julia {
    fn value(&self, p: DVec3, most: u32) -> (f64, u32) {
        let all = self.follow(p, most, 1.0);
        (all.value, all.iterations)
    }

    fn lipschitz(&self) -> f64 {
        self.0.lipschitz
    }

    fn ball(&self, p: DVec3, most: u32, trial: f64) -> Reading {
        self.follow(p, most, trial)
    }

    fn trap(&self, p: DVec3, most: u32) -> DVec3 {
        self.0.trap(p, self.0.julia, most)
    }

    fn traps(&self, p: DVec3, most: u32) -> [f64; 7] {
        self.0.traps(p, self.0.julia, most)
    }

    fn trap_lanes(&self, at: &Places, most: u32) -> [DVec3; LANES] {
        dispatch!(level(), simd => self.0.trap_lanes(simd, at, Some(self.0.julia), most))
    }

    fn has_lanes(&self) -> bool {
        true
    }

    fn values(&self, at: &Places, most: u32) -> [f64; LANES] {
        let all = dispatch!(level(), simd => self.follow_lanes(simd, at, most, None));
        all.map(|all| all.value)
    }

    fn steps(&self, at: &Places, most: u32, clear: &[f64; LANES]) -> [Reading; LANES] {
        let mut all = dispatch!(level(), simd => self.follow_lanes(simd, at, most, None));
        for (all, clear) in all.iter_mut().zip(clear) {
            all.radius = (all.value - clear) / self.lipschitz();
        }
        all
    }

    fn cones(&self, at: &Places, most: u32, trial: &[f64; LANES]) -> [Reading; LANES] {
        self.balls(at, most, trial)
    }

    fn balls(&self, at: &Places, most: u32, trial: &[f64; LANES]) -> [Reading; LANES] {
        dispatch!(level(), simd => self.follow_lanes(simd, at, most, Some(trial)))
    }
}
