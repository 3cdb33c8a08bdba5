//! The Mandelbox (docs/method.md, 3).
//!
//! An iteration folds a point at a box and at a ball, rotates it, scales it, and adds the
//! starting point, or a constant in Julia mode. This file has the parameters and the bounds; the
//! estimates are in `orbit`, `julia` and `scalar`.

use bytemuck::bytes_of;
use glam::DVec3;

use crate::base::key::{Fault, Key, auto_number, number, switch, triple, word};
use crate::base::named::named_enum;
use crate::base::shader::Module;
use crate::formula::contract::{Bounds, DistanceEstimate, Evaluator};
use crate::formula::folds::Folds;
use crate::formula::julia::Julia;
use crate::formula::orbit::{Orbits, ROTATED_SLOPE};
use crate::formula::rotation::Rotation;
use crate::formula::scalar::Scalar;
use crate::{settings, wgsl};

/// 2 sqrt(3). A box fold moves a point by at most this times the fold limit.
const TWO_SQRT_3: f64 = 3.464_101_615_137_754_6;

/// An orbit has escaped at this multiple of K. A smaller one is as correct, but makes the
/// estimate lower: at 5 by some per cent.
const BAIL_FACTOR: f64 = 20.0;

named_enum! {
    /// A distance estimate.
    pub enum Estimate {
        /// The sharpest one, which follows the Jacobian of the first iterations.
        Tight = "tight",
        /// `(|z| - K) / (w + 1/(|s| - 1))`: one growth factor w for all directions.
        Scalar = "scalar",
        /// `(|z| - |s - 1|)/w - |s|^(1 - N)`: the form of other programs, for comparison. It
        /// is too large at up to 8 % of points.
        Classic = "classic",
    }
}

settings! {
    /// The Mandelbox and its parameters.
    pub struct Mandelbox {
        scale: f64 = 2.0, number(-100.0, 100.0), "factor by which each iteration scales the point after the folds; its absolute value must be at least 1.001";
        min_radius: f64 = 0.5, number(1e-6, 1e3), "inner radius of the ball fold; at most fixed_radius";
        fixed_radius: f64 = 1.0, number(1e-6, 1e3), "outer radius of the ball fold; at least min_radius";
        fold_limit: f64 = 1.0, number(1e-3, 1e3), "half edge of the box at whose sides the box fold mirrors points";
        rotation: DVec3 = DVec3::ZERO, triple(-36e3, 36e3),
            "rotation about x, then y, then z in degrees, between the folds and the scale" => Program;
        julia: bool = false, switch(), "whether each iteration adds julia_constant instead of the starting point" => Program;
        julia_constant: DVec3 = DVec3::ZERO, triple(-1e3, 1e3), "the constant that each iteration adds if julia is true";
        estimate: Estimate = Estimate::Tight, word(&Estimate::WORDS), "the distance estimate: the sharpest one, or for comparison the one with a scalar growth factor or the classic one of other programs" => Program;
        lipschitz: Option<f64> = None, auto_number(0.05, 100.0),
            "Lipschitz constant, the largest change of the estimate per unit of distance; steps are divided by it; auto is the formula's own";
    }
}

impl Mandelbox {
    fn rotated(&self) -> Option<Rotation> {
        Rotation::new(self.rotation)
    }

    /// 1 / (|s| - 1).
    fn tail(&self) -> f64 {
        1.0 / (self.scale.abs() - 1.0)
    }

    /// K for |c|.
    fn k(&self, c: f64) -> f64 {
        TWO_SQRT_3 * self.fold_limit * self.scale.abs() * self.tail() + c * self.tail()
    }

    /// The largest |c| of any orbit.
    fn largest_c(&self) -> f64 {
        if self.julia {
            self.julia_constant.length()
        } else {
            self.bounds().radius
        }
    }

    /// The resolved numbers.
    fn folds(&self) -> Folds {
        let k = self.k(self.largest_c());
        Folds {
            julia: self.julia_constant,
            rotation: self.rotated(),
            scale: self.scale,
            fold_limit: self.fold_limit,
            radii: [self.min_radius, self.fixed_radius],
            lipschitz: self
                .lipschitz
                .unwrap_or_else(|| slope(self.scale, self.rotated().is_some())),
            bail2: (BAIL_FACTOR * k).powi(2),
            tail: self.tail(),
            k_at_zero: self.k(0.0),
            lead: 2.0 * self.fold_limit * self.scale.abs() * self.tail(),
            kappa: 1.0 / (self.scale + 1.0),
        }
    }
}

impl DistanceEstimate for Mandelbox {
    fn name(&self) -> &'static str {
        "mandelbox"
    }

    fn keys(&mut self) -> Vec<Key<'_>> {
        self.keys()
    }

    fn check(&self) -> Result<(), Fault> {
        Fault::unless(
            // Below this the bounds exceed 4000 fold limits: too large for f32.
            self.scale.abs() >= 1.001,
            "scene.scale",
            "its absolute value must be at least 1.001; 2 and -1.5 are classics",
        )?;
        Fault::unless(
            self.min_radius <= self.fixed_radius,
            "scene.min_radius",
            format!("it must not exceed fixed_radius, {}", self.fixed_radius),
        )
    }

    fn modules(&self) -> Vec<Module> {
        let switch = |on: bool| f64::from(u8::from(on));
        let mut all = vec![
            wgsl!(
                "formula/folds.wgsl",
                "FOLDS_JULIA" = switch(self.julia),
                "FOLDS_FOLLOWED" = switch(self.scale > 0.0)
            ),
            Rotation::module(self.rotated().as_ref()),
        ];
        all.extend(match (self.estimate, self.julia) {
            (Estimate::Tight, false) => vec![
                wgsl!("formula/orbit.wgsl", "ORBIT_ROTATED_SLOPE" = ROTATED_SLOPE),
                Rotation::jacobian(self.rotated().as_ref()),
            ],
            (Estimate::Tight, true) => vec![wgsl!("formula/julia.wgsl")],
            (other, _) => {
                let classic = switch(other == Estimate::Classic);
                vec![
                    wgsl!("formula/scalar.wgsl", "SCALAR_CLASSIC" = classic),
                    wgsl!("formula/plain.wgsl"),
                ]
            }
        });
        all
    }

    fn uniforms(&self, iterations: u32) -> Vec<(&'static str, Vec<u8>)> {
        let folds = self.folds();
        let rows = Rotation::uniform(folds.rotation.as_ref());
        vec![
            (
                "folds_parameters",
                bytes_of(&folds.uniform(iterations)).to_vec(),
            ),
            ("rotation_parameters", bytes_of(&rows).to_vec()),
        ]
    }

    fn sharpen(&mut self) {
        self.estimate = Estimate::Tight;
    }

    fn evaluator(&self) -> Evaluator {
        let (folds, julia) = (self.folds(), self.julia);
        match (self.estimate, julia) {
            (Estimate::Tight, false) => Evaluator::new(Orbits(folds)),
            (Estimate::Tight, true) => Evaluator::new(Julia(folds)),
            (other, _) => Evaluator::new(Scalar {
                folds,
                julia,
                classic: other == Estimate::Classic,
            }),
        }
    }

    fn traps_module(&self) -> Module {
        wgsl!("formula/traps_folds.wgsl")
    }

    fn four_module(&self) -> Module {
        match (self.estimate, self.rotated()) {
            (Estimate::Tight, None) => wgsl!("formula/four_folds.wgsl"),
            _ => wgsl!("formula/four_plain.wgsl").replacing("wgsl/formula/four_folds.wgsl"),
        }
    }

    fn bounds(&self) -> Bounds {
        let (s, l) = (self.scale, self.fold_limit);
        let rotated = self.rotated().is_some();
        let (half, radius) = if self.julia {
            let c = self.julia_constant.abs();
            let k = self.k(c.length());
            let unturned = (DVec3::splat(2.0 * l * s.abs()) + c) * self.tail();
            (if rotated { DVec3::splat(k) } else { unturned }, k)
        } else if rotated {
            let radius = TWO_SQRT_3 * l * (s.abs() + 1.0) * self.tail();
            (DVec3::splat(radius), radius)
        } else if s > 0.0 {
            let edge = 2.0 * l * (s + 1.0) * self.tail();
            (DVec3::splat(edge), f64::INFINITY)
        } else {
            (DVec3::splat(2.0 * l), f64::INFINITY)
        };
        Bounds {
            centre: DVec3::ZERO,
            half,
            radius: half.length().min(radius),
        }
    }

    fn iterations(&self, eps: f64) -> u32 {
        let s = self.scale.abs();
        let c = self.largest_c();
        let skin = TWO_SQRT_3 * self.fold_limit * s + 2.0 * c;
        let n = if self.julia {
            (skin * self.tail() / eps).ln() / s.ln()
        } else {
            (1.0 + skin / eps).ln() / s.ln() - 1.0
        };
        n.ceil().clamp(2.0, 1e6) as u32
    }
}

/// The Lipschitz constant at a scale, with or without a rotation: by so much the steps of rays are
/// shortened.
///
/// The derivative along an orbit is that at one point and not over a step, so a ball that reaches
/// into the zone of a ball fold can be too large. docs/method.md, 3 tells by how much steps are
/// still too long; the tests in `tests/solids/oversteps.rs` search for them.
fn slope(scale: f64, rotated: bool) -> f64 {
    if scale > 2.25 {
        1.2
    } else if scale < -1.6 || (scale < 0.0 && rotated) {
        1.25
    } else if rotated {
        1.1
    } else {
        1.0
    }
}
