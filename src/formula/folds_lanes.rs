//! Iterations of Mandelboxes side by side: [`Folds`] lane by lane, with the same bits.

use fearless_simd::prelude::*;
use glam::DVec3;

use crate::base::lanes::{LANES, Mask, Places, Reals, Triples, mask};
use crate::formula::folds::Folds;

/// The folds of a point of each lane; see [`crate::formula::folds::Fold`].
#[derive(Clone, Copy)]
pub struct FoldLanes<S: Simd> {
    /// The points after the box fold.
    pub b: Triples<S>,
    /// Their squared lengths.
    pub square: Reals<S>,
    /// The factors of the ball fold.
    pub m: Reals<S>,
}

impl<S: Simd> FoldLanes<S> {
    /// The lengths after the box fold.
    #[inline(always)]
    pub fn length(&self) -> Reals<S> {
        self.square.sqrt()
    }
}

impl Folds {
    /// See [`Folds::fold`].
    #[inline(always)]
    pub fn fold_lanes<S: Simd>(&self, z: Triples<S>) -> FoldLanes<S> {
        let limit = self.fold_limit;
        let b = z.max(-limit).min(limit) * 2.0 - z;
        let square = b.dot(b);
        let [low, high] = self.radii.map(|r| r * r);
        FoldLanes {
            b,
            square,
            m: high / square.max(low).min(high),
        }
    }

    /// A rotated point.
    #[inline(always)]
    pub fn turn_lanes<S: Simd>(&self, v: Triples<S>) -> Triples<S> {
        let Some(rotation) = &self.rotation else {
            return v;
        };
        let [x, y, z] = rotation.columns();
        Triples {
            x: v.x * x.x + v.y * y.x + v.z * z.x,
            y: v.x * x.y + v.y * y.y + v.z * z.y,
            z: v.x * x.z + v.y * y.z + v.z * z.z,
        }
    }

    /// See [`Folds::next`].
    #[inline(always)]
    pub fn next_lanes<S: Simd>(&self, fold: &FoldLanes<S>, c: Triples<S>) -> Triples<S> {
        self.turn_lanes(fold.b) * fold.m * self.scale + c
    }

    /// See [`Folds::growth`].
    #[inline(always)]
    pub fn growth_lanes<S: Simd>(&self, fold: &FoldLanes<S>) -> Reals<S> {
        fold.m * self.scale.abs()
    }

    /// See [`Folds::k`].
    #[inline(always)]
    pub fn k_lanes<S: Simd>(&self, c: Triples<S>) -> Reals<S> {
        c.length() * self.tail + self.k_at_zero
    }

    /// See [`Folds::exit`].
    #[inline(always)]
    pub fn exit_lanes<S: Simd>(&self, c: Triples<S>) -> Reals<S> {
        let shift = c.abs().max_element() * self.kappa.abs();
        let lead = shift + self.lead;
        let unfolded = shift + (self.radii[1] - 2.0 * self.fold_limit * self.tail);
        let unfolded = lead + unfolded.max(0.0);
        (lead + (lead * 0.05).max(4.0 * self.fold_limit)).max(unfolded)
    }

    /// See [`Folds::ended`].
    #[inline(always)]
    pub fn ended_lanes<S: Simd>(&self, z: Triples<S>, exit: Reals<S>) -> Mask<S> {
        match self.rotation {
            None => z.abs().max_element().simd_gt(exit),
            Some(_) => z.dot(z).simd_gt(self.bail2),
        }
    }

    /// See [`Folds::top`].
    #[inline(always)]
    pub fn top_lanes<S: Simd>(&self, z: Triples<S>, c: Triples<S>) -> Reals<S> {
        match self.rotation {
            None => {
                let lead = Reals::splat(z.x.simd, self.lead);
                ((z - c * self.kappa).abs() - lead).max(0.0).length()
            }
            Some(_) => (z.length() - self.k_lanes(c)).max(0.0),
        }
    }

    /// See [`Folds::trap`]. Without a constant, orbits add their starting points.
    #[inline(always)]
    pub fn trap_lanes<S: Simd>(
        &self,
        simd: S,
        at: &Places,
        constant: Option<DVec3>,
        most: u32,
    ) -> [DVec3; LANES] {
        let high = self.radii[1].powi(2);
        let mut z = Triples::of(simd, &at.points);
        let c = constant.map_or(z, |c| Triples::all(simd, c));
        let far = Reals::splat(simd, 1e10);
        let (mut origin, mut plane, mut sphere) = (far, far, far);
        let mut on = mask(simd, &at.on);
        for _ in 0..most.min(10) {
            on &= !z.dot(z).simd_gt(self.bail2);
            if on.all_false() {
                break;
            }
            let fold = self.fold_lanes(z);
            let b2 = fold.square;
            origin = on.select(origin.min(b2), origin);
            plane = on.select(plane.min(fold.b.abs().min_element()), plane);
            sphere = on.select(sphere.min((b2 - high).abs()), sphere);
            z = Triples::select(on, self.next_lanes(&fold, c), z);
        }
        let size = self.fold_limit;
        let root = origin.sqrt();
        let x: [f64; LANES] = (root / (root + size)).into();
        let y: [f64; LANES] = (plane / (plane + 0.25 * size)).into();
        let z: [f64; LANES] = (sphere / (sphere + high)).into();
        std::array::from_fn(|i| DVec3::new(x[i], y[i], z[i]))
    }
}
