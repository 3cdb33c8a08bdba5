//! What a formula promises.

use glam::DVec3;

use crate::base::key::{Fault, Key};
use crate::base::shader::Module;

/// A region that holds everything: a box about a centre, cut by a ball about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Centre of both.
    pub centre: DVec3,
    /// Half extents of the box.
    pub half: DVec3,
    /// Radius of the ball.
    pub radius: f64,
}

impl Bounds {
    /// A box about the origin, with the ball about its corners.
    pub fn cuboid(half: DVec3) -> Self {
        Self {
            centre: DVec3::ZERO,
            half,
            radius: half.length(),
        }
    }

    /// A lower bound of the distance to the region, 0 inside.
    pub fn distance(&self, p: DVec3) -> f64 {
        let o = ((p - self.centre).abs() - self.half).max(DVec3::ZERO);
        o.length()
            .max(((p - self.centre).length() - self.radius).max(0.0))
    }

    /// The region's greatest distance from a point.
    pub fn farthest(&self, p: DVec3) -> f64 {
        let corner = (p - self.centre).abs() + self.half;
        corner
            .length()
            .min((p - self.centre).length() + self.radius)
    }
}

/// A distance-estimated shape. Each has a WGSL twin with functions of the same names.
pub trait DistanceEstimate {
    /// Name in presets, also that of its files.
    fn name(&self) -> &'static str;

    /// The keys that it reads in `[scene]`.
    fn keys(&mut self) -> Vec<Key<'_>>;

    /// Whether the parameters fit together.
    fn check(&self) -> Result<(), Fault>;

    /// The WGSL twin with its constants, and stand-ins for what it does not use.
    fn modules(&self) -> Vec<Module>;

    /// Bytes of the uniforms, by the name of the WGSL variable. `iterations` is the
    /// limit that the estimate will run under.
    fn uniforms(&self, iterations: u32) -> Vec<(&'static str, Vec<u8>)>;

    /// Signed estimate of the distance to the surface, at most 0 inside, and the fold
    /// iterations spent on it.
    fn estimate(&self, p: DVec3, most: u32) -> (f64, u32);

    /// Three orbit traps in 0..1, for colour.
    fn trap(&self, p: DVec3, most: u32) -> DVec3;

    /// The estimate's largest slope: steps divide by it.
    fn lipschitz(&self) -> f64;

    /// A region outside which there is nothing.
    fn bounds(&self) -> Bounds;

    /// Iterations after which the estimate is within `eps` of converged.
    fn iterations(&self, eps: f64) -> u32;
}
