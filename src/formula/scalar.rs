//! Estimates of the Mandelbox with one growth factor for all directions, for comparison: the one
//! that never exceeds the limit of |z|/w, and the classic one (docs/method.md, 3).
//! Twin: `wgsl/formula/scalar.wgsl`.

use glam::DVec3;

use crate::formula::contract::Evaluate;
use crate::formula::folds::Folds;

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
}
