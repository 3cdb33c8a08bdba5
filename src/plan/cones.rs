//! Whether cones make a render faster (docs/method.md, 2).
//!
//! Cones save the steps that the rays of a block share. Close to the surface every pixel needs
//! its own steps, and after cones these differ more between neighbours, which wait for each other.
//! So cones are faster where they leave the rays few of their steps. A few rays tell.

use crate::base::outcome::Counts;
use crate::base::view::{Beam, View};
use crate::plan::Plan;
use crate::plan::march::Mode;
use crate::plan::pyramid::Level;
use crate::scene::{Advance, Solid, Step, Task};

/// Rays along each axis of the picture.
const RAYS: [u32; 2] = [16, 9];
/// The rays are followed in this stride, which has no factor in common with their number. So the first
/// ones are spread over the picture.
const STRIDE: u32 = 89;
/// After so many rays, the others are left out if what cones save or lose is more than this share of
/// what rays alone need.
const SURE: (u32, f64) = (36, 0.2);

/// When cones pay: if `price` times the evaluations of the cones, for each sample, and those of the rays
/// after them, are less than a share of the evaluations of rays alone. The share is less than 1, as rays
/// after cones wait longer for each other.
pub struct Rule {
    /// What an evaluation of a cone weighs.
    pub price: f64,
    /// The share for one sample of each pixel, and for several.
    pub shares: [f64; 2],
}

impl Rule {
    /// The rule for a scene and a mode.
    pub fn of(plan: &Plan) -> Self {
        match plan.scene.tells_distance() {
            true if plan.march.mode == Mode::Proven => PROVEN,
            true => DISTANCE,
            false => HEIGHTS,
        }
    }
}

/// Over a formula. Price and shares are fitted to the times of all built-in presets, with one sample and
/// with 16 (`bench formula_cones`).
const DISTANCE: Rule = Rule {
    price: 2.3,
    shares: [0.74, 0.85],
};
/// In mode `proven`, where rays go by balls as cones do (`bench formula_cones -- march.mode=proven`).
const PROVEN: Rule = Rule {
    price: 1.4,
    ..DISTANCE
};
/// Over heights the cones cost so little that only the rays are compared. Over the built-in heightfields
/// from 640 x 360 on, cones are faster up to 0.81 and rays alone from 0.845 on; with 16 samples cones up to
/// 0.90, and rays alone from 0.97 on.
const HEIGHTS: Rule = Rule {
    price: 0.0,
    shares: [0.84, 0.9],
};

/// Follows a few rays.
pub struct Probe {
    /// The view.
    pub view: View,
    /// Its width and height in pixels.
    pub size: [u32; 2],
    /// The step limit of a ray.
    pub steps: u32,
    /// The levels of the cones.
    pub levels: Vec<Level>,
    /// Samples of each pixel.
    pub samples: u32,
    /// When cones pay.
    pub rule: Rule,
}

impl Probe {
    /// The pixel in the middle of one of the parts of the picture.
    fn pixel(&self, i: u32) -> [u32; 2] {
        let middle = |axis: usize, i: u32| {
            let at = u64::from(2 * i + 1) * u64::from(self.size[axis]);
            (at / u64::from(2 * RAYS[axis])) as u32
        };
        [middle(0, i % RAYS[0]), middle(1, i / RAYS[0])]
    }

    /// Evaluations of a ray from a front on.
    fn follow<S: Solid>(&self, solid: &S, ray: &Beam, front: f64) -> f64 {
        let mut work = Counts::default();
        let mut walk = solid.begin(ray, front, solid.bounds_far(), &mut work);
        for _ in 0..self.steps {
            if solid.walk_step(ray, &mut walk, &mut work) != Step::Moving {
                break;
            }
        }
        f64::from(work.evaluations)
    }

    /// The front of a pixel's finest cone, and the pixel's part of the evaluations of its cones.
    fn cones<S: Solid>(&self, solid: &S, pixel: [u32; 2]) -> (f64, f64) {
        let (mut front, mut evaluations) = (0.0, 0.0);
        for level in &self.levels {
            let cone = self
                .view
                .view_cone(pixel.map(|n| n / level.divisor), level.divisor);
            let mut work = Counts::default();
            let mut at = Advance::at(front, true);
            for _ in 0..level.steps {
                at = solid.advance(&cone, at, &mut work);
                if !at.going || at.front > solid.bounds_far() {
                    break;
                }
            }
            front = at.front;
            evaluations += f64::from(work.evaluations) / f64::from(level.divisor.pow(2));
            if front > solid.bounds_far() {
                break;
            }
        }
        (front, evaluations)
    }
}

impl Task for Probe {
    /// Whether cones pay.
    type Output = bool;

    fn run<S: Solid>(self, solid: &S) -> bool {
        let [mut alone, mut cones, mut left] = [0.0; 3];
        let share = self.rule.shares[usize::from(self.samples > 1)];
        let all = RAYS[0] * RAYS[1];
        let mut saved = 0.0;
        for n in 1..=all {
            let pixel = self.pixel(n * STRIDE % all);
            let ray = self.view.view_ray(pixel);
            alone += self.follow(solid, &ray, 0.0);
            let (front, evaluations) = self.cones(solid, pixel);
            cones += evaluations;
            if front <= solid.bounds_far() {
                left += self.follow(solid, &ray, front);
            }
            saved = share * alone - left - self.rule.price * cones / f64::from(self.samples);
            if n >= SURE.0 && saved.abs() > SURE.1 * alone {
                break;
            }
        }
        saved > 0.0
    }
}
