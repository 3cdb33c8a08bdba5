//! Whether cones make a render faster (docs/method.md, 2).
//!
//! Cones save the steps that the rays of a block share. Close to the surface every pixel needs
//! its own steps, and after cones these differ more between neighbours, which wait for each other.
//! So cones are faster where they leave the rays few of their steps. A few rays tell.

use crate::base::outcome::Counts;
use crate::base::view::View;
use crate::plan::Plan;
use crate::plan::march;
use crate::plan::pyramid::Level;
use crate::scene::{Advance, Assets, Solid, Step, Task};

/// Rays along each axis of the picture.
const RAYS: [u32; 2] = [16, 9];
/// The rays are followed in parts.
const PARTS: u32 = 4;
/// The stride between rays that follow each other. It has no factor in common with their number, so
/// each part is spread over the picture.
const STRIDE: u32 = 89;
/// The parts that are left are skipped if what cones save or lose is more than this share of what rays
/// alone need.
const SURE: f64 = 0.2;

/// When cones pay: `(price * cones + passes) / samples + after < share * alone`, in evaluations for each pixel.
/// `cones` are those of the cones, `after` those of the rays after them, and `alone` those of rays alone.
/// The share is less than 1, as rays after cones wait longer for each other.
pub struct Rule {
    /// What an evaluation of a cone weighs.
    pub price: f64,
    /// What the passes of the cones cost for each pixel, however few their steps, in evaluations.
    pub passes: f64,
    /// The share for one sample of each pixel, and for several.
    shares: [f64; 2],
}

impl Rule {
    /// The rule for a scene and a mode.
    pub fn of(plan: &Plan) -> Self {
        match plan.scene.tells_distance() {
            true if plan.march.stepping().proven => PROVEN,
            true => DISTANCE,
            false => HEIGHTS,
        }
    }
}

/// Over a formula. Price, passes and shares are fitted to the times of all built-in presets, with one sample and
/// with 16 (`cargo bench --bench formula_cones`).
const DISTANCE: Rule = Rule {
    price: 1.8,
    passes: 0.3,
    shares: [0.72, 0.85],
};
/// In mode `proven`, where rays go by balls as cones do (`cargo bench --bench formula_cones -- march.mode=proven`).
const PROVEN: Rule = Rule {
    price: 1.4,
    ..DISTANCE
};
/// Over heights the cones cost so little that only the rays are compared. Over the built-in heightfields
/// from 640 x 360 on, cones are faster up to 0.81 and rays alone from 0.845 on; with 16 samples cones up to
/// 0.90, and rays alone from 0.97 on.
const HEIGHTS: Rule = Rule {
    price: 0.0,
    passes: 0.0,
    shares: [0.84, 0.9],
};

/// Whether cones save more time than they take on a few cores.
pub fn pay(plan: &Plan, assets: &Assets) -> bool {
    if plan.size.map(u64::from).iter().product::<u64>() < plan.scene.cone_pixels() {
        return false;
    }
    // Rays alone have another shell.
    let solid = |coarsest| {
        let mut plan = plan.clone();
        plan.march.coarsest = coarsest;
        plan.scene.probed(&plan.viewpoint(), assets)
    };
    let (Some(alone), Some(with)) = (solid(Some(1)), solid(None)) else {
        return true;
    };
    let levels = plan.march.levels();
    let rule = Rule::of(plan);
    let samples = f64::from(plan.samples);
    let share = rule.shares[usize::from(plan.samples > 1)];
    let (mut needed, mut saved) = (0.0, 0.0);
    for part in 0..PARTS {
        let follow = |levels| Follow {
            view: plan.view(),
            size: plan.size,
            // A low limit does not make rays cheap: it leaves more of them unfinished.
            steps: plan.march.ray_steps(None).max(march::STEPS),
            part,
            levels,
        };
        let rays = alone.run(follow(&[])).rays;
        let after = with.run(follow(&levels));
        needed += rays;
        let passes = rule.passes * f64::from(RAYS[0] * RAYS[1] / PARTS);
        let cones = rule.price * after.cones + passes;
        saved += share * rays - after.rays - cones / samples;
        if saved.abs() > SURE * needed {
            break;
        }
    }
    saved > 0.0
}

/// Follows some rays of a view from the fronts of cones.
struct Follow<'a> {
    view: View,
    /// The width and height of the picture in pixels.
    size: [u32; 2],
    /// The step limit of a ray.
    steps: u32,
    part: u32,
    /// The levels of the cones.
    levels: &'a [Level],
}

/// Evaluations.
#[derive(Default)]
struct Evaluations {
    rays: f64,
    /// The pixels' parts of those of their cones.
    cones: f64,
}

impl Task for Follow<'_> {
    type Output = Evaluations;

    fn run<S: Solid>(self, solid: &S) -> Evaluations {
        let mut sum = Evaluations::default();
        let all = RAYS[0] * RAYS[1];
        for n in self.part * all / PARTS..(self.part + 1) * all / PARTS {
            let pixel = self.pixel(n * STRIDE % all);
            let front = self.cones(solid, pixel, &mut sum);
            if front <= solid.bounds_far() {
                self.ray(solid, pixel, front, &mut sum);
            }
        }
        sum
    }
}

impl Follow<'_> {
    /// The pixel in the middle of one of the parts of the picture.
    fn pixel(&self, i: u32) -> [u32; 2] {
        let middle = |axis: usize, i: u32| {
            let at = u64::from(2 * i + 1) * u64::from(self.size[axis]);
            (at / u64::from(2 * RAYS[axis])) as u32
        };
        [middle(0, i % RAYS[0]), middle(1, i / RAYS[0])]
    }

    fn ray<S: Solid>(&self, solid: &S, pixel: [u32; 2], front: f64, sum: &mut Evaluations) {
        let ray = self.view.view_ray(pixel);
        let mut work = Counts::default();
        let mut walk = solid.begin(&ray, front, solid.bounds_far(), &mut work);
        for _ in 0..self.steps {
            if solid.walk_step(&ray, &mut walk, &mut work) != Step::Moving {
                break;
            }
        }
        sum.rays += f64::from(work.evaluations);
    }

    /// The front of a pixel's finest cone.
    fn cones<S: Solid>(&self, solid: &S, pixel: [u32; 2], sum: &mut Evaluations) -> f64 {
        let mut front = 0.0;
        for level in self.levels {
            let cell = pixel.map(|n| n / level.divisor);
            let cone = self.view.view_cone(cell, level.divisor);
            let mut work = Counts::default();
            let mut at = Advance::at(front, true);
            for _ in 0..level.steps {
                at = solid.advance(&cone, at, &mut work);
                if !at.going || at.front > solid.bounds_far() {
                    break;
                }
            }
            front = at.front;
            sum.cones += f64::from(work.evaluations) / f64::from(level.divisor.pow(2));
            if front > solid.bounds_far() {
                break;
            }
        }
        front
    }
}
