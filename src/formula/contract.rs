//! The trait of all formulas, and the region that holds a shape.

use glam::DVec3;

use crate::base::key::{Fault, Key};
use crate::base::shader::Module;

/// A region that holds a shape: a box cut by a ball about the same centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Centre of box and ball.
    pub centre: DVec3,
    /// Half extents of the box.
    pub half: DVec3,
    /// Radius of the ball.
    pub radius: f64,
}

impl Bounds {
    /// A box about the origin, with the ball through its corners.
    pub fn cuboid(half: DVec3) -> Self {
        Self {
            centre: DVec3::ZERO,
            half,
            radius: half.length(),
        }
    }

    /// A lower bound of the distance to the region; 0 inside.
    pub fn distance(&self, p: DVec3) -> f64 {
        let off = p - self.centre;
        let beside = (off.abs() - self.half).max(DVec3::ZERO);
        beside.length().max(off.length() - self.radius)
    }

    /// An upper bound of the distance from a point to any point of the region.
    pub fn farthest(&self, p: DVec3) -> f64 {
        let off = p - self.centre;
        let corner = off.abs() + self.half;
        corner.length().min(off.length() + self.radius)
    }
}

/// A shape given by an estimate of the distance to it. Its WGSL twin has the functions
/// `formula_load`, `estimate` and `trap`.
pub trait DistanceEstimate {
    /// Name in presets, and of the two files.
    fn name(&self) -> &'static str;

    /// The keys of its parameters in `[scene]`.
    fn keys(&mut self) -> Vec<Key<'_>>;

    /// Checks that the parameters fit together.
    fn check(&self) -> Result<(), Fault> {
        Ok(())
    }

    /// The WGSL modules with their constants.
    fn modules(&self) -> Vec<Module>;

    /// The bytes of each WGSL parameter variable. `iterations` is the iteration limit of the
    /// estimate.
    fn uniforms(&self, iterations: u32) -> Vec<(&'static str, Vec<u8>)>;

    /// The estimate of the distance at a point after at most `most` iterations, and the number
    /// of iterations. Inside the shape the estimate is at most 0.
    fn estimate(&self, p: DVec3, most: u32) -> (f64, u32);

    /// Three orbit traps from 0 to 1, which pick the colour: how near the orbit of a point
    /// comes to three sets.
    fn trap(&self, p: DVec3, most: u32) -> DVec3;

    /// The Lipschitz constant: a bound of the estimate's slope. Steps divide by it.
    fn lipschitz(&self) -> f64;

    /// A region that holds the whole shape.
    fn bounds(&self) -> Bounds;

    /// The number of iterations after which the estimate is within `eps` of its limit.
    fn iterations(&self, eps: f64) -> u32;
}
