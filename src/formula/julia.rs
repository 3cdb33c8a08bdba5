//! The Mandelbox in Julia mode: every iteration adds the same constant (docs/method.md, 3).
//! Twin: `wgsl/formula/julia.wgsl`.

use glam::DVec3;

use crate::formula::contract::{Evaluate, Reading};
use crate::formula::folds::Folds;

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
                // Outside the fixed sphere, it bends only what the trial ball has inside.
                let inverse = ((1.0 / trial - bend) / w).max(0.0);
                let inside = 1.0 - (fold.length - high).max(0.0) * inverse;
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
}
