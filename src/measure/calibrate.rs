//! Probes of a plan's estimate, which propose settings for it (docs/method.md, 2).
//!
//! Exact cones assume that the estimate never exceeds the distance, and steps assume that
//! thin parts of the surface are not jumped over. A scene may break these assumptions, or
//! leave room for faster settings. Probes are pixels spread evenly over the image. Each is
//! traced in tiny steps for its true hit, and then through all cones above it. The result
//! is the Lipschitz constant, the smallest shell and the narrowest cones that lose no more
//! pixels than a budget allows. The budget is for the whole picture and the probes are few, so
//! the standard error is added to each counted share, and other probes check the result.

use std::ops::Range;

use rayon::prelude::*;
use serde::Serialize;

use crate::base::outcome::State;
use crate::base::view::footprint;
use crate::cpu;
use crate::gpu::RenderError;
use crate::plan::Plan;
use crate::plan::march::Mode;
use crate::scene::{Assets, Solid, Task};

/// Factor on the steps that find the true hits.
const STRIDE: f64 = 0.05;
/// A pixel whose hit is farther behind the true one, in footprints, is lost.
const BEHIND: f64 = 2.0;
/// The shells to try.
const SHELLS: [f64; 10] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// The factors on cones to try, narrowest first, in twentieths.
const FUDGES: Range<u8> = 6..20;

/// Share of the time that the probes take, for progress: the rest is for trying settings.
const PROBING: f64 = 0.5;

/// Standard errors that are added to a counted share. One true share in forty is still larger.
const DOUBT: f64 = 2.0;

/// An upper bound of the true share, given the share counted on so many probes. A count of 0
/// stays 0, so that a budget of 0 can be met.
fn at_most(share: f64, probes: usize) -> f64 {
    let n = probes.max(1) as f64;
    share + DOUBT * (share * (1.0 - share) / n).sqrt()
}

/// A pixel and its true hit.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    /// The pixel.
    pub pixel: [u32; 2],
    /// Distance of the hit, if there is one.
    pub hit: Option<f64>,
    /// The footprint there.
    pub grain: f64,
}

/// Proposed settings, and what the probes found.
#[derive(Clone, Debug, Serialize)]
pub struct Calibration {
    /// The largest slope of the estimate.
    pub slope: f64,
    /// The median ratio of the true distance to the estimate.
    pub slack: f64,
    /// The proposed Lipschitz constant.
    pub lipschitz: f64,
    /// The proposed shell.
    pub shell: f64,
    /// The proposed factors on the cones, coarse to fine.
    pub fudge: Vec<f64>,
    /// Share of the other probes that the proposal loses.
    pub lost: f64,
    /// Whether the budget holds, on the first probes with their error and on the others.
    pub within: bool,
    /// The other probes, to check a picture with.
    #[serde(skip)]
    pub probes: Vec<Probe>,
}

impl Calibration {
    /// A plan with the proposed settings.
    pub fn apply(&self, plan: &Plan) -> Plan {
        let mut plan = plan.clone();
        plan.march.mode = Mode::Calibrated;
        plan.march.shell = Some(self.shell);
        plan.march.fudge.clone_from(&self.fudge);
        plan
    }
}

/// Proposes settings that lose at most a share `budget` of the pixels. It uses `rays` probes,
/// and as many others to check the result.
///
/// # Errors
/// [`RenderError::Cancelled`] if `going` returns `false`; it is told the share that is done. A named file cannot be read.
pub fn calibrate(
    plan: &Plan,
    assets: &Assets,
    budget: f64,
    rays: usize,
    going: &mut dyn FnMut(f64) -> bool,
) -> Result<Calibration, RenderError> {
    let mut truth = plan.clone();
    truth.march.mode = Mode::Truth;
    truth.march.stride = Some(STRIDE);
    truth.march.clip = Some(true);
    let view = plan.view();
    let mut probes = Vec::new();
    let pixels = spread(plan.size, 2 * rays);
    let mut check = |share: f64| match going(share) {
        true => Ok(()),
        false => Err(RenderError::Cancelled),
    };
    // In parts, so that it can stop between them.
    for part in pixels.chunks(256) {
        let hits = cpu::sample(&truth, assets, part)?;
        probes.extend(part.iter().zip(hits).map(|(pixel, (hit, state))| Probe {
            pixel: *pixel,
            hit: (state == State::Hit).then_some(hit.t),
            grain: footprint(&view.view_ray(*pixel), hit.t),
        }));
        check(PROBING * probes.len() as f64 / pixels.len() as f64)?;
    }
    let others = probes.split_off(rays.min(probes.len()));
    let known = &probes;
    let solid = plan.scene.solid(&plan.viewpoint(), assets)?;
    let (slope, slack) = solid.run(Slopes {
        plan,
        probes: known,
    });
    let mut lost = |plan: &Plan, share: f64| {
        check(share)?;
        Ok::<_, RenderError>(at_most(lost_share(plan, assets, &probes)?, probes.len()))
    };
    let mut best = plan.clone();
    best.march.mode = Mode::Calibrated;
    best.march.fudge = vec![1.0];
    // The shell may use half of the budget, narrower cones the rest.
    for shell in SHELLS {
        best.march.shell = Some(shell);
        if lost(&best, PROBING)? <= 0.5 * budget {
            break;
        }
    }
    let levels = best.levels().len();
    best.march.fudge = vec![1.0; levels.max(1)];
    let exact = lost(&best, PROBING)?;
    for level in 0..levels {
        let share = (level + 1) as f64 / levels as f64;
        let allowed = exact + (budget - exact).max(0.0) * share;
        for f in FUDGES {
            best.march.fudge[level] = f64::from(f) / 20.0;
            let share = PROBING + (1.0 - PROBING) * level as f64 / levels as f64;
            if lost(&best, share)? <= allowed {
                break;
            }
            best.march.fudge[level] = 1.0;
        }
    }
    let held = lost(&best, 1.0)? <= budget;
    let lost = lost_share(&best, assets, &others)?;
    Ok(Calibration {
        slope,
        slack,
        // These rays may have missed a slope of 1.
        lipschitz: (100.0 * slope.max(1.0)).ceil() / 100.0,
        shell: best.march.shell(),
        fudge: best.march.fudge,
        lost,
        within: held && lost <= budget,
        probes: others,
    })
}

/// Pixels spread evenly over an image, by Roberts' additive sequence in two dimensions. Its
/// steps are powers of the inverse of the plastic number.
fn spread(size: [u32; 2], count: usize) -> Vec<[u32; 2]> {
    const STEPS: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053_3];
    (0..count)
        .map(|n| [0, 1].map(|i| ((0.5 + n as f64 * STEPS[i]).fract() * f64::from(size[i])) as u32))
        .collect()
}

/// Finds the largest slope of the ball's radius before a hit, and the median slack.
struct Slopes<'a> {
    plan: &'a Plan,
    probes: &'a [Probe],
}

impl Task for Slopes<'_> {
    type Output = (f64, f64);

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let view = self.plan.view();
        // The clearance is the estimate over the preset's own constant.
        let own = self.plan.scene.lipschitz();
        let one = |probe: &Probe| {
            let ray = view.view_ray(probe.pixel);
            let hit = probe.hit?;
            let mut before = 0.5 * hit;
            let mut ratios = Vec::new();
            while before > 8.0 * probe.grain {
                let radius = solid.clearance(ray.at(hit - before));
                // The hit is up to a threshold before the surface.
                ratios.push(own * radius / (before + BEHIND * probe.grain));
                before *= 0.7;
            }
            Some(ratios)
        };
        let mut all: Vec<f64> = self.probes.par_iter().filter_map(one).flatten().collect();
        all.sort_by(f64::total_cmp);
        let slope = all.last().copied().unwrap_or(1.0);
        let middle = all.get(all.len() / 2).copied().unwrap_or(1.0);
        (slope, 1.0 / middle.max(1e-9))
    }
}

/// The share of probes that a plan loses: shown too deep, as sky, or unconverged.
fn lost_share(plan: &Plan, assets: &Assets, probes: &[Probe]) -> Result<f64, RenderError> {
    let hits = probes
        .iter()
        .filter_map(|p| Some((p.pixel, p.hit? + BEHIND * p.grain)));
    let (pixels, most): (Vec<_>, Vec<f64>) = hits.unzip();
    let found = cpu::sample(plan, assets, &pixels)?.into_iter().zip(most);
    let lost = found.filter(|((met, state), most)| *state != State::Hit || met.t > *most);
    Ok(lost.count() as f64 / probes.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::{Formula, balls::Balls, mandelbox::Mandelbox};

    fn plan(shape: Formula) -> Plan {
        let mut plan = Plan::new(shape);
        plan.camera.eye = glam::DVec3::new(3.0, 2.5, -9.0);
        (plan.size, plan.reference) = ([160, 90], None);
        plan
    }

    #[test]
    fn an_exact_field_has_slope_one_and_takes_full_cones() {
        let plan = plan(Formula::Balls(Balls::default()));
        let assets = Assets::default();
        let found = calibrate(&plan, &assets, 0.0, 2000, &mut |_| true).expect("not stopped");
        let slope = found.slope;
        assert!(slope <= 1.0 + 1e-9 && slope > 0.9, "{slope}");
        assert!((found.lipschitz - 1.0).abs() < 1e-12);
        // It loses none of the probes and hardly one of the others.
        assert!(found.lost < 0.005, "{}", found.lost);
        assert_eq!(found.within, found.lost == 0.0);
        // Narrow cones lose pixels of an exact field. Only the finest cones may be narrow, as
        // a cone through pixel centres is wider than its four rays.
        assert!(found.fudge[0] > 0.5, "{:?}", found.fudge);
        assert!(calibrate(&plan, &assets, 0.0, 2000, &mut |_| false).is_err());
    }

    #[test]
    fn a_slack_estimate_affords_narrower_cones_than_an_exact_one() {
        let of = |scale| {
            let shape = Mandelbox {
                scale,
                ..Mandelbox::default()
            };
            let (plan, assets) = (plan(Formula::Mandelbox(shape)), Assets::default());
            calibrate(&plan, &assets, 0.01, 1500, &mut |_| true).expect("not stopped")
        };
        // The estimate understates the distance at scale 2, and hardly at -1.5.
        let (slack, tight) = (of(2.0), of(-1.5));
        assert!(slack.slack > tight.slack, "{} {}", slack.slack, tight.slack);
        // Factors of up to 0.8 were found, as this camera also sees slopes near 1.
        let widest = slack.fudge.iter().copied().fold(0.0, f64::max);
        assert!(slack.within && widest < 0.85, "{:?}", slack.fudge);
    }
}
