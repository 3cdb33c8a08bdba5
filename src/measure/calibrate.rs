//! What a preset can afford: probes of its estimate along random camera rays.
//!
//! Exact cones assume an estimate that never exceeds the distance; steps assume that thin
//! skins are not jumped over. How far a scene is from either, or how much better than it,
//! is a property of the scene (docs/method.md, 2). The probes follow rays through evenly spread
//! pixels in tiny steps, and then the whole chain of cones above each of them, and propose
//! the slope that steps should divide by, the smallest shell, and the narrowest cones for
//! which no more pixels are lost than a budget allows: not only of the probes, which are few
//! and chosen by, but of the picture. So a share that was counted is taken for what it may
//! well be, and what is told in the end was counted on as many other pixels.

use rayon::prelude::*;

use crate::base::view::{View, footprint};
use crate::base::work::{State, Work};
use crate::gpu::RenderError;
use crate::pass::march::{Ended, march};
use crate::pass::trace::trace;
use crate::plan::Plan;
use crate::plan::march::Mode;
use crate::scene::Assets;
use crate::scene::{Solid, Task};

/// Factor on the estimate's steps for the probes' own truth.
const STRIDE: f64 = 0.05;
/// A pixel deeper than this, in footprints, is lost, as it is behind in comparisons.
const BEHIND: f64 = 2.0;
/// Shells that are tried.
const SHELLS: [f64; 10] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Factors on cones that are tried, from the narrowest.
const FUDGES: [f64; 14] = [
    0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95,
];

/// Standard errors that are added to a counted share: one in forty is larger by more.
const DOUBT: f64 = 2.0;

/// What a share may well be that was counted on so many probes. None lost is taken for
/// none: a budget of nothing could not be held otherwise.
fn at_most(share: f64, probes: usize) -> f64 {
    let n = probes.max(1) as f64;
    share + DOUBT * (share * (1.0 - share) / n).sqrt()
}

/// A pixel and its truth.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    /// The pixel.
    pub pixel: [u32; 2],
    /// Distance of the hit, where there is one.
    pub hit: Option<f64>,
    /// Half a pixel's width there.
    pub grain: f64,
}

/// What is proposed.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The largest slope of the estimate that the probes met.
    pub slope: f64,
    /// How many times farther than the estimate says the surface is, in the median.
    pub slack: f64,
    /// What steps should divide by.
    pub lipschitz: f64,
    /// Share of the hit threshold that steps keep clear of.
    pub shell: f64,
    /// Factor on the cones of each level, coarse to fine.
    pub fudge: Vec<f64>,
    /// Share of other probes that the proposal loses.
    pub lost: f64,
    /// Whether the budget holds, on the probes with their doubt and on the others.
    pub within: bool,
    /// The other probes, to check a picture with.
    pub probes: Vec<Probe>,
}

impl Calibration {
    /// A plan with the proposal.
    pub fn apply(&self, plan: &Plan) -> Plan {
        let mut plan = plan.clone();
        plan.march.mode = Mode::Calibrated;
        plan.march.shell = self.shell;
        plan.march.fudge.clone_from(&self.fudge);
        plan
    }
}

/// Proposes settings that lose at most the share `budget` of pixels, from so many rays,
/// and counts what they lose on as many others.
///
/// # Errors
/// [`RenderError::Cancelled`] if `going` says to stop; a named file cannot be read.
pub fn calibrate(
    plan: &Plan,
    assets: &Assets,
    budget: f64,
    rays: usize,
    going: &dyn Fn() -> bool,
) -> Result<Calibration, RenderError> {
    let mut truth = plan.clone();
    truth.march.mode = Mode::Truth;
    truth.march.stride = Some(STRIDE);
    truth.march.clip = Some(true);
    let mut probes = Vec::new();
    let pixels = spread(plan.size, 2 * rays);
    // In parts, so that one can stop in between.
    for part in pixels.chunks(256) {
        probes.extend(truth.solid(assets)?.run(Follow {
            plan: &truth,
            limit: truth.ray_steps(assets),
            pixels: part,
        }));
        if !going() {
            return Err(RenderError::Cancelled);
        }
    }
    let others = probes.split_off(rays.min(probes.len()));
    let (slope, slack) = plan.solid(assets)?.run(Slopes {
        plan,
        probes: &probes,
    });
    let count = |plan: &Plan, probes: &[Probe]| {
        let limit = plan.ray_steps(assets);
        let lost = Lost {
            plan,
            limit,
            probes,
        };
        Ok::<_, RenderError>(plan.solid(assets)?.run(lost))
    };
    let lost = |plan: &Plan| Ok::<_, RenderError>(at_most(count(plan, &probes)?, probes.len()));
    let mut best = plan.clone();
    best.march.mode = Mode::Calibrated;
    best.march.fudge = vec![1.0];
    // Half of the budget for the shell, the rest for narrower cones.
    for shell in SHELLS {
        best.march.shell = shell;
        if !going() {
            return Err(RenderError::Cancelled);
        }
        if lost(&best)? <= 0.5 * budget {
            break;
        }
    }
    let levels = best.pyramid().levels.len();
    let mut fudge = vec![1.0; levels];
    let exact = lost(&best)?;
    for level in 0..levels {
        let share = (level + 1) as f64 / levels as f64;
        let allowed = exact + (budget - exact).max(0.0) * share;
        for f in FUDGES {
            fudge[level] = f;
            best.march.fudge.clone_from(&fudge);
            if !going() {
                return Err(RenderError::Cancelled);
            }
            if lost(&best)? <= allowed {
                break;
            }
            fudge[level] = 1.0;
        }
    }
    best.march.fudge = if fudge.is_empty() { vec![1.0] } else { fudge };
    let held = lost(&best)? <= budget;
    let lost = count(&best, &others)?;
    Ok(Calibration {
        slope,
        slack,
        // A slope under 1 was only not met by these rays.
        lipschitz: (100.0 * slope.max(1.0)).ceil() / 100.0,
        shell: best.march.shell,
        fudge: best.march.fudge,
        lost,
        within: held && lost <= budget,
        probes: others,
    })
}

/// Pixels spread evenly over an image: Roberts' additive sequence in two dimensions,
/// whose steps are powers of the inverse of the plastic number.
fn spread(size: [u32; 2], count: usize) -> Vec<[u32; 2]> {
    const STEPS: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053_3];
    (0..count)
        .map(|n| [0, 1].map(|i| ((0.5 + n as f64 * STEPS[i]).fract() * f64::from(size[i])) as u32))
        .collect()
}

struct Follow<'a> {
    plan: &'a Plan,
    limit: u32,
    pixels: &'a [[u32; 2]],
}

impl Task for Follow<'_> {
    type Output = Vec<Probe>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let view = self.plan.view();
        let limit = self.limit;
        let one = |&pixel: &[u32; 2]| {
            let ray = view.view_ray(pixel);
            let (hit, state) = trace(solid, &ray, 0.0, limit, &mut Work::default());
            Probe {
                pixel,
                hit: (state == State::Hit).then_some(hit.t),
                grain: footprint(&ray, hit.t),
            }
        };
        self.pixels.par_iter().map(one).collect()
    }
}

/// The largest slope of the ball's radius before a hit, and the median slack.
struct Slopes<'a> {
    plan: &'a Plan,
    probes: &'a [Probe],
}

impl Task for Slopes<'_> {
    type Output = (f64, f64);

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let view = self.plan.view();
        // Radii are the estimate over what the preset divides by already.
        let own = self.plan.scene.lipschitz();
        let one = |probe: &Probe| {
            let ray = view.view_ray(probe.pixel);
            let hit = probe.hit?;
            let mut before = 0.5 * hit;
            let mut ratios = Vec::new();
            while before > 8.0 * probe.grain {
                let radius = solid.clearance(ray.at(hit - before));
                // The hit itself lies within a threshold of the surface.
                ratios.push(own * radius / (before + BEHIND * probe.grain));
                before *= 0.7;
            }
            Some(ratios)
        };
        let found: Vec<Vec<f64>> = self.probes.par_iter().filter_map(one).collect();
        let mut all: Vec<f64> = found.into_iter().flatten().collect();
        all.sort_by(f64::total_cmp);
        let slope = all.last().copied().unwrap_or(1.0);
        let middle = all.get(all.len() / 2).copied().unwrap_or(1.0);
        (slope, 1.0 / middle.max(1e-9))
    }
}

/// Share of probes that a plan loses: shown too deep, as sky, or not finished.
struct Lost<'a> {
    plan: &'a Plan,
    limit: u32,
    probes: &'a [Probe],
}

impl Task for Lost<'_> {
    type Output = f64;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let view = self.plan.view();
        let levels = self.plan.pyramid().levels;
        let limit = self.limit;
        let one = |probe: &&Probe| {
            let Some(hit) = probe.hit else { return false };
            let Some(front) = front(solid, &view, &levels, probe.pixel) else {
                return true;
            };
            let ray = view.view_ray(probe.pixel);
            let (met, state) = trace(solid, &ray, front, limit, &mut Work::default());
            state != State::Hit || met.t > hit + BEHIND * probe.grain
        };
        let lost = self.probes.par_iter().filter(one).count();
        lost as f64 / self.probes.len().max(1) as f64
    }
}

/// Where the cones above a pixel end; `None` if one of them claims sky.
fn front<S: Solid>(
    solid: &S,
    view: &View,
    levels: &[crate::plan::pyramid::Level],
    pixel: [u32; 2],
) -> Option<f64> {
    let mut front = 0.0;
    for level in levels {
        let mut cone = view.view_cone(pixel.map(|p| p / level.divisor), level.divisor);
        cone.k *= level.fudge;
        let work = &mut Work::default();
        let (next, ended) = march(solid, &cone, front, level.steps, work);
        if ended == Ended::Sky {
            return None;
        }
        front = next;
    }
    Some(front)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::{Formula, balls::Balls, mandelbox::Mandelbox};

    fn plan(shape: Formula) -> Plan {
        let mut plan = Plan::new(shape);
        plan.camera.eye = glam::DVec3::new(3.0, 2.5, -9.0);
        plan.size = [160, 90];
        plan
    }

    #[test]
    fn an_exact_field_has_slope_one_and_takes_full_cones() {
        let plan = plan(Formula::Balls(Balls::default()));
        let found = calibrate(&plan, &Assets::default(), 0.0, 2000, &|| true).expect("not stopped");
        assert!(
            found.slope <= 1.0 + 1e-9 && found.slope > 0.9,
            "{}",
            found.slope
        );
        assert!((found.lipschitz - 1.0).abs() < 1e-12);
        // None of the probes is lost, and hardly one of the others, which is told.
        assert!(found.lost < 0.005, "{}", found.lost);
        assert_eq!(found.within, found.lost == 0.0);
        // Narrow cones do lose pixels of an exact field; the finest may be narrow, since a
        // cone through pixel centres is wider than the four rays in it.
        assert!(found.fudge[0] > 0.5, "{:?}", found.fudge);
        assert!(calibrate(&plan, &Assets::default(), 0.0, 2000, &|| false).is_err());
    }

    #[test]
    fn a_slack_estimate_affords_narrower_cones_than_an_exact_one() {
        let of = |scale| {
            let shape = Formula::Mandelbox(Mandelbox {
                scale,
                ..Mandelbox::default()
            });
            calibrate(&plan(shape), &Assets::default(), 0.01, 1500, &|| true).expect("not stopped")
        };
        // Cones can be told thinner than they are where the estimate understates the
        // distance, as it does at scale 2 and hardly at -1.5.
        let (slack, tight) = (of(2.0), of(-1.5));
        assert!(slack.slack > tight.slack, "{} {}", slack.slack, tight.slack);
        // Up to 0.8 was found, on a camera that sees slopes near one too.
        let widest = slack.fudge.iter().copied().fold(0.0, f64::max);
        assert!(slack.within && widest < 0.85, "{:?}", slack.fudge);
    }
}
