//! Numbers of several points side by side, which a processor computes at once.
//!
//! Every lane has the operations of the code for one point, in the same order, and never a fused
//! multiplication and addition. So it has the same bits.

use std::ops::{Add, Mul, Sub};
use std::sync::LazyLock;

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x8, mask64x8};
use glam::DVec3;

/// Points side by side. One orbit waits for each of its operations; eight keep a core busy.
pub const LANES: usize = 8;

/// A number of each lane.
pub type Reals<S> = f64x8<S>;
/// A truth of each lane.
pub type Mask<S> = mask64x8<S>;

/// The points of lanes.
#[derive(Clone, Copy, Debug)]
pub struct Places {
    /// A point of each lane.
    pub points: [DVec3; LANES],
    /// Which lanes count. The others tell nothing of use.
    pub on: [bool; LANES],
}

impl Places {
    /// The results of a function of the lane's number and point, lane by lane.
    pub fn each<T: Default>(&self, mut of: impl FnMut(usize, DVec3) -> T) -> [T; LANES] {
        std::array::from_fn(|i| match self.on[i] {
            true => of(i, self.points[i]),
            false => T::default(),
        })
    }
}

/// What the processor can do.
pub fn level() -> Level {
    static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);
    *LEVEL
}

/// A truth of each lane.
#[inline(always)]
pub fn mask<S: Simd>(simd: S, on: &[bool; LANES]) -> Mask<S> {
    Mask::simd_from(simd, on.map(|on| -i64::from(on)))
}

/// A point of each lane.
#[derive(Clone, Copy)]
pub struct Triples<S: Simd> {
    /// Its coordinates.
    pub x: Reals<S>,
    /// See `x`.
    pub y: Reals<S>,
    /// See `x`.
    pub z: Reals<S>,
}

impl<S: Simd> Triples<S> {
    /// The points of the lanes.
    #[inline(always)]
    pub fn of(simd: S, p: &[DVec3; LANES]) -> Self {
        Self {
            x: Reals::simd_from(simd, p.map(|p| p.x)),
            y: Reals::simd_from(simd, p.map(|p| p.y)),
            z: Reals::simd_from(simd, p.map(|p| p.z)),
        }
    }

    /// The same point in all lanes.
    #[inline(always)]
    pub fn all(simd: S, p: DVec3) -> Self {
        Self::of(simd, &[p; LANES])
    }

    /// The absolute value of each coordinate.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self {
            x: self.x.abs(),
            y: self.y.abs(),
            z: self.z.abs(),
        }
    }

    /// The larger one of each coordinate and a number.
    #[inline(always)]
    #[must_use]
    pub fn max(self, least: f64) -> Self {
        Self {
            x: self.x.max(least),
            y: self.y.max(least),
            z: self.z.max(least),
        }
    }

    /// The smaller one of each coordinate and a number.
    #[inline(always)]
    #[must_use]
    pub fn min(self, most: f64) -> Self {
        Self {
            x: self.x.min(most),
            y: self.y.min(most),
            z: self.z.min(most),
        }
    }

    /// The largest coordinate.
    #[inline(always)]
    pub fn max_element(self) -> Reals<S> {
        self.x.max(self.y.max(self.z))
    }

    /// The smallest coordinate.
    #[inline(always)]
    pub fn min_element(self) -> Reals<S> {
        self.x.min(self.y.min(self.z))
    }

    /// The scalar product.
    #[inline(always)]
    pub fn dot(self, by: Self) -> Reals<S> {
        self.x * by.x + self.y * by.y + self.z * by.z
    }

    /// The length.
    #[inline(always)]
    pub fn length(self) -> Reals<S> {
        self.dot(self).sqrt()
    }

    /// The products of the coordinates.
    #[inline(always)]
    #[must_use]
    pub fn times(self, by: Self) -> Self {
        Self {
            x: self.x * by.x,
            y: self.y * by.y,
            z: self.z * by.z,
        }
    }

    /// A choice for each lane.
    #[inline(always)]
    #[must_use]
    pub fn select(on: Mask<S>, yes: Self, no: Self) -> Self {
        Self {
            x: on.select(yes.x, no.x),
            y: on.select(yes.y, no.y),
            z: on.select(yes.z, no.z),
        }
    }
}

impl<S: Simd> Add for Triples<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, by: Self) -> Self {
        Self {
            x: self.x + by.x,
            y: self.y + by.y,
            z: self.z + by.z,
        }
    }
}

impl<S: Simd> Sub for Triples<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, by: Self) -> Self {
        Self {
            x: self.x - by.x,
            y: self.y - by.y,
            z: self.z - by.z,
        }
    }
}

/// Less a number from each coordinate.
impl<S: Simd> Sub<Reals<S>> for Triples<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, by: Reals<S>) -> Self {
        Self {
            x: self.x - by,
            y: self.y - by,
            z: self.z - by,
        }
    }
}

impl<S: Simd> Mul<Reals<S>> for Triples<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, by: Reals<S>) -> Self {
        Self {
            x: self.x * by,
            y: self.y * by,
            z: self.z * by,
        }
    }
}

impl<S: Simd> Mul<f64> for Triples<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, by: f64) -> Self {
        Self {
            x: self.x * by,
            y: self.y * by,
            z: self.z * by,
        }
    }
}
