//! Estimates of the Mandelbox with one growth factor for all directions, for comparison: the one
//! that never exceeds the limit of |z|/w, and the classic one (docs/method.md, 3).
//! Twin: `wgsl/formula/scalar.wgsl`.

use fearless_simd::dispatch;
use fearless_simd::prelude::*;
use glam::DVec3;

use crate::base::lanes::{LANES, Places, Reals, Triples, level, mask};
use crate::formula::contract::{Evaluate, Reading};
use crate::formula::folds::Folds;
use crate::formula::orbit_lanes::readings;

/// The estimate `(|z| - K)/(w + 1/(|s| - 1))`, or in Julia mode `(|z| - K)/w`.
#[derive(Clone, Debug)]
pub struct Scalar {
    /// The numbers.
    pub folds: Folds,
    /// Whether the orbit adds a constant.
    pub julia: bool,
    /// Whether the estimate is the classic one, `(|z| - |s - 1|)/w - |s|^(1 - N)`.
    pub classic: bool,
}

impl Scalar {
    /// What orbits add instead of their starting points in Julia mode.
    fn constant(&self) -> Option<DVec3> {
        self.julia.then_some(self.folds.julia)
    }

    /// The estimates of several points, with the bits of [`Evaluate::value`], and their iterations.
    /// The radii are the estimates less `clear`, divided by the Lipschitz constant.
    #[inline(always)]
    fn value_lanes<S: Simd>(
        &self,
        simd: S,
        at: &Places,
        most: u32,
        clear: &[f64; LANES],
    ) -> [Reading; LANES] {
        let Self { folds, .. } = self;
        let p = Triples::of(simd, &at.points);
        let (c, gain, tail) = match self.julia {
            true => (Triples::all(simd, folds.julia), 0.0, 0.0),
            false => (p, 1.0, folds.tail),
        };
        let all = |x| Reals::splat(simd, x);
        let (one, none) = (all(1.0), all(0.0));
        let (mut z, mut w, mut n) = (p, one, none);
        let mut on = mask(simd, &at.on);
        for _ in 0..most {
            on &= z.dot(z).simd_le(folds.bail2);
            if on.all_false() {
                break;
            }
            let fold = folds.fold_lanes(z);
            w = on.select((folds.growth_lanes(&fold) * w + gain).min(1e300), w);
            z = Triples::select(on, folds.next_lanes(&fold, c), z);
            n += on.select(one, none);
        }
        let d = match self.classic {
            true => (z.length() - (folds.scale - 1.0).abs()) / w - folds.classic_skin(most),
            false => (z.length() - folds.k_lanes(c)) / (w + tail),
        };
        let radius = (d - Reals::simd_from(simd, *clear)) / folds.lipschitz;
        readings(d, radius, n)
    }
}

impl Evaluate for Scalar {
    fn value(&self, p: DVec3, most: u32) -> (f64, u32) {
        let Self { folds, .. } = self;
        let (c, gain, tail) = match self.julia {
            true => (folds.julia, 0.0, 0.0),
            false => (p, 1.0, folds.tail),
        };
        let (mut z, mut w, mut n) = (p, 1.0_f64, 0);
        while n < most && z.length_squared() <= folds.bail2 {
            let fold = folds.fold(z);
            // Kept finite. The estimate is zero in f64 long before this limit.
            w = (folds.growth(&fold) * w + gain).min(1e300);
            z = folds.next(&fold, c);
            n += 1;
        }
        let d = match self.classic {
            true => (z.length() - (folds.scale - 1.0).abs()) / w - folds.classic_skin(most),
            false => (z.length() - folds.k(c)) / (w + tail),
        };
        (d, n)
    }

    fn lipschitz(&self) -> f64 {
        self.folds.lipschitz
    }

    fn trap(&self, p: DVec3, most: u32) -> DVec3 {
        self.folds.trap(p, self.constant().unwrap_or(p), most)
    }

    fn traps(&self, p: DVec3, most: u32) -> [f64; 7] {
        self.folds.traps(p, self.constant().unwrap_or(p), most)
    }

    fn trap_lanes(&self, at: &Places, most: u32) -> [DVec3; LANES] {
        dispatch!(level(), simd => self.folds.trap_lanes(simd, at, self.constant(), most))
    }

    fn has_lanes(&self) -> bool {
        true
    }

    fn values(&self, at: &Places, most: u32) -> [f64; LANES] {
        self.steps(at, most, &[0.0; LANES]).map(|all| all.value)
    }

    fn steps(&self, at: &Places, most: u32, clear: &[f64; LANES]) -> [Reading; LANES] {
        dispatch!(level(), simd => self.value_lanes(simd, at, most, clear))
    }

    fn cones(&self, at: &Places, most: u32, trial: &[f64; LANES]) -> [Reading; LANES] {
        self.balls(at, most, trial)
    }

    fn balls(&self, at: &Places, most: u32, _: &[f64; LANES]) -> [Reading; LANES] {
        self.steps(at, most, &[0.0; LANES])
    }
}
