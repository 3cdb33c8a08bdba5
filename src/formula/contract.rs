//! The trait of all formulas, and the region that holds a shape.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use glam::DVec3;

use crate::base::key::{Fault, Key};
use crate::base::lanes::{LANES, Places};
use crate::base::shader::Module;
use crate::formula::traps::Traps;
use crate::wgsl;

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

/// What an evaluation tells about a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// The estimate of the distance. It decides hits and normals, and depends on the point alone.
    pub value: f64,
    /// The radius of a ball about the point. What it holds depends on what was asked.
    pub radius: f64,
    /// Iterations that it took.
    pub iterations: u32,
}

/// A formula with its parameters resolved, ready for many points. Points are given with an
/// iteration limit.
pub trait Evaluate: Send + Sync {
    /// The estimate at a point, and the number of iterations. Inside the shape the estimate is at
    /// most 0.
    fn value(&self, p: DVec3, most: u32) -> (f64, u32);

    /// The Lipschitz constant: a bound of the estimate's slope. Steps of rays divide by it.
    fn lipschitz(&self) -> f64 {
        1.0
    }

    /// For steps of rays: a ball in which the estimate should exceed `clear`.
    fn step(&self, p: DVec3, most: u32, clear: f64) -> Reading {
        let (value, iterations) = self.value(p, most);
        Reading {
            value,
            radius: (value - clear) / self.lipschitz(),
            iterations,
        }
    }

    /// For cones: an empty ball, of which at most `trial` is tried.
    fn cone(&self, p: DVec3, most: u32, trial: f64) -> Reading {
        self.ball(p, most, trial)
    }

    /// For steps that need a proof: an empty ball. A proof may need to know how large a ball is
    /// tried; then the radius is at most `trial`.
    fn ball(&self, p: DVec3, most: u32, _trial: f64) -> Reading {
        self.step(p, most, 0.0)
    }

    /// Three orbit traps from 0 to 1, which pick the colour: how near the orbit of a point
    /// comes to three sets.
    fn trap(&self, p: DVec3, most: u32) -> DVec3;

    /// The numbers of all traps ([`Traps::numbers`]): of a formula without orbits those of the
    /// place itself.
    fn traps(&self, p: DVec3, _most: u32) -> [f64; 7] {
        let mut all = Traps::FAR;
        all.add(p, 1.0);
        all.numbers(1.0)
    }

    /// Whether points side by side cost less than one by one.
    fn has_lanes(&self) -> bool {
        false
    }

    /// The estimates of [`Self::value`] at several points.
    fn values(&self, at: &Places, most: u32) -> [f64; LANES] {
        at.each(|_, p| self.value(p, most).0)
    }

    /// [`Self::step`] at several points.
    fn steps(&self, at: &Places, most: u32, clear: &[f64; LANES]) -> [Reading; LANES] {
        at.each(|i, p| self.step(p, most, clear[i]))
    }

    /// [`Self::cone`] at several points.
    fn cones(&self, at: &Places, most: u32, trial: &[f64; LANES]) -> [Reading; LANES] {
        at.each(|i, p| self.cone(p, most, trial[i]))
    }

    /// [`Self::ball`] at several points.
    fn balls(&self, at: &Places, most: u32, trial: &[f64; LANES]) -> [Reading; LANES] {
        at.each(|i, p| self.ball(p, most, trial[i]))
    }

    /// [`Self::trap`] at several points.
    fn trap_lanes(&self, at: &Places, most: u32) -> [DVec3; LANES] {
        at.each(|_, p| self.trap(p, most))
    }
}

/// A shared evaluator.
#[derive(Clone)]
pub struct Evaluator(Arc<dyn Evaluate>);

impl Evaluator {
    /// Shares an evaluator.
    pub fn new(of: impl Evaluate + 'static) -> Self {
        Self(Arc::new(of))
    }
}

impl Deref for Evaluator {
    type Target = dyn Evaluate;
    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl fmt::Debug for Evaluator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Evaluator").finish_non_exhaustive()
    }
}

/// A shape given by an estimate of the distance to it. Its WGSL twin has the functions
/// `formula_load`, `formula_lipschitz`, `estimate` and `trap`. Those of [`Evaluate::step`],
/// `cone` and `ball` are in `wgsl/formula/plain.wgsl`, or its own.
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

    /// Resolves the parameters.
    fn evaluator(&self) -> Evaluator;

    /// Chooses its sharpest estimate, if it has several.
    fn sharpen(&mut self) {}

    /// The estimate of the distance at one point; see [`Evaluate::value`].
    fn estimate(&self, p: DVec3, most: u32) -> (f64, u32) {
        self.evaluator().value(p, most)
    }

    /// See [`Evaluate::trap`].
    fn trap(&self, p: DVec3, most: u32) -> DVec3 {
        self.evaluator().trap(p, most)
    }

    /// The WGSL module with the twin of [`Evaluate::traps`].
    fn traps_module(&self) -> Module {
        wgsl!("formula/traps_plain.wgsl")
    }

    /// The WGSL module with `estimate_four`: the estimates at four points. One that computes them
    /// side by side is faster.
    fn four_module(&self) -> Module {
        wgsl!("formula/four_plain.wgsl")
    }

    /// See [`Evaluate::lipschitz`].
    fn lipschitz(&self) -> f64 {
        self.evaluator().lipschitz()
    }

    /// A region that holds the whole shape.
    fn bounds(&self) -> Bounds;

    /// The number of iterations after which the estimate is within `eps` of its limit.
    fn iterations(&self, eps: f64) -> u32;
}
