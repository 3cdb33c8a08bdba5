//! How sharp a picture is: how far its visible surface lies in front of the *set*, the shape itself
//! (docs/method.md, 5).
//!
//! A ray ends at the hit threshold, in front of the set. How far in front depends on the estimate.
//! With a slack estimate, rays end early. So pictures of different estimates are compared at equal
//! sharpness, and not at equal thresholds.

use serde::{Deserialize, Serialize};

use crate::base::outcome::State;
use crate::base::view::footprint;
use crate::cpu;
use crate::gpu::RenderError;
use crate::measure::compare::quantile;
use crate::measure::truth::asked;
use crate::picture::frame::Frame;
use crate::plan::Plan;
use crate::scene::Assets;

/// One in so many pixels of a row is sampled.
const SAMPLE: usize = 16;
/// Each row begins so many pixels after the one above, so that all places within a cell are sampled.
const SHIFT: usize = 5;
/// Rays to the set end at this share of the plan's hit threshold.
const SHARPER: f64 = 1.0 / 16.0;
/// A front is a start violation if it is beyond the set by more than this share of a footprint,
/// which is twice the threshold of the rays to the set.
const BEYOND: f64 = 2.0 * SHARPER;
/// A pixel is wrong if it is so many footprints behind the set.
const BEHIND: f64 = 2.0;

/// Where sampled rays meet the set.
#[derive(Clone, Debug)]
pub struct SetSample {
    /// Numbers of the pixels, and the distances of their hits; infinity for none.
    hits: Vec<(usize, f64)>,
}

/// By how many footprints the seen surface lies before the set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BeforeSet {
    /// Half of the pixels are closer to the set.
    pub median: f64,
    /// 95 % are.
    pub p95: f64,
}

/// A frame compared with the set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sharpness {
    /// How far the seen surface lies before the set.
    pub before_set: BeforeSet,
    /// Share of the sampled pixels that are more than 2 footprints behind the set, show sky
    /// before it, or have not converged.
    pub wrong_of_set: f64,
    /// For each kept cone level, coarse to fine, the sampled pixels whose cell starts beyond
    /// the set.
    pub starts_beyond_set: Vec<u64>,
}

/// Samples the set of a plan, in f64: the sharpest estimate, marched to a sixteenth of the hit
/// threshold. `stride` is the factor on the steps with which the plan's truth converges.
///
/// # Errors
/// A named file cannot be read.
pub fn sample(plan: &Plan, assets: &Assets, stride: f64) -> Result<SetSample, RenderError> {
    let mut finer = asked(plan);
    finer.scene = finer.scene.sharpest().unwrap_or(finer.scene);
    finer.march.detail *= SHARPER;
    finer.march.stride = Some(stride);
    let [width, height] = plan.size.map(|n| n as usize);
    let row = |y: usize| {
        (y * SHIFT % SAMPLE..width)
            .step_by(SAMPLE)
            .map(move |x| y * width + x)
    };
    let numbers: Vec<usize> = (0..height).flat_map(row).collect();
    let pixels = numbers.iter();
    let pixels: Vec<_> = pixels
        .map(|i| [i % width, i / width].map(|n| n as u32))
        .collect();
    let found = cpu::sample(&finer, assets, &pixels)?.into_iter();
    let far = found.map(|(hit, state)| match state {
        State::Hit => hit.t,
        _ => f64::INFINITY,
    });
    Ok(SetSample {
        hits: numbers.into_iter().zip(far).collect(),
    })
}

/// Compares a frame of a plan with the plan's set.
pub fn sharpness(frame: &Frame, set: &SetSample, plan: &Plan) -> Sharpness {
    let view = plan.view();
    let width = plan.size[0] as usize;
    let mut before = Vec::new();
    let mut wrong = 0;
    let mut starts_beyond_set = vec![0; frame.levels.len()];
    for &(i, set) in set.hits.iter() {
        let [x, y] = [i % width, i / width];
        let ray = view.view_ray([x as u32, y as u32]);
        let grain = footprint(&ray, set).max(f64::MIN_POSITIVE);
        let state = frame.state[i];
        wrong += usize::from(state == State::Unconverged as u8);
        if set.is_infinite() {
            continue;
        }
        wrong += usize::from(state == State::Sky as u8);
        if state == State::Hit as u8 {
            let by = (set - f64::from(frame.depth[i])) / grain;
            wrong += usize::from(by < -BEHIND);
            before.push(by);
        }
        for (level, beyond) in frame.levels.iter().zip(&mut starts_beyond_set) {
            let d = level.divisor as usize;
            let cell = (y / d) * level.cells[0] as usize + x / d;
            let front = level.front.get(cell).copied().unwrap_or_default();
            *beyond += u64::from(f64::from(front) > set + BEYOND * plan.march.detail * grain);
        }
    }
    before.sort_by(f64::total_cmp);
    Sharpness {
        before_set: BeforeSet {
            median: quantile(&before, 0.5),
            p95: quantile(&before, 0.95),
        },
        wrong_of_set: wrong as f64 / set.hits.len().max(1) as f64,
        starts_beyond_set,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::{Formula, mandelbox::Mandelbox};
    use crate::plan::Extras;
    use crate::scene::Scene;
    use crate::scene::slab::SlabSettings;

    fn compared(plan: &Plan, change: impl Fn(&mut Frame)) -> Sharpness {
        let assets = Assets::default();
        let set = sample(plan, &assets, 0.1).expect("it names no file");
        let extras = Extras {
            levels: true,
            ..Extras::default()
        };
        let frame = cpu::render(plan, &assets, extras, &mut |_| true);
        let mut frame = frame.expect("rendered");
        change(&mut frame);
        sharpness(&frame, &set, plan)
    }

    #[test]
    fn a_slack_estimate_and_a_larger_threshold_end_rays_farther_from_the_set() {
        let of = |estimate: &str, detail: f64| {
            let mut shape = Formula::Mandelbox(Mandelbox::default());
            let mut keys = shape.keys();
            let key = keys.iter_mut().find(|k| k.name == "estimate");
            key.expect("there")
                .slot
                .set(&estimate.into())
                .expect("known");
            drop(keys);
            let mut plan = Plan::new(Scene::from(shape));
            plan.size = [96, 64];
            plan.march.detail = detail;
            compared(&plan, |_| {}).before_set.median
        };
        let found = [("tight", 1.0), ("scalar", 1.0), ("tight", 2.0)].map(|(e, d)| of(e, d));
        let [tight, slack, coarse] = found;
        assert!(tight > 0.3, "{found:?}");
        assert!(slack > 1.05 * tight && coarse > 1.3 * tight, "{found:?}");
    }

    #[test]
    fn exact_hits_lie_on_the_set_and_moved_ones_do_not() {
        let mut plan = Plan::new(SlabSettings::default());
        plan.size = [64, 48];
        let exact = compared(&plan, |_| {});
        assert!(exact.before_set.median.abs() < 1e-2, "{exact:?}");
        assert_eq!(exact.wrong_of_set, 0.0);
        assert!(exact.starts_beyond_set.iter().all(|n| *n == 0));
        let deeper = compared(&plan, |frame| {
            frame.depth.iter_mut().for_each(|t| *t *= 1.1);
            for level in &mut frame.levels {
                level.front.iter_mut().for_each(|t| *t += 100.0);
            }
        });
        assert!(deeper.before_set.median < -2.0 && deeper.wrong_of_set > 0.1);
        assert!(deeper.starts_beyond_set.iter().all(|n| *n > 10));
        let sky = |frame: &mut Frame| frame.state.fill(State::Sky as u8);
        assert!(compared(&plan, sky).wrong_of_set > 0.1);
    }
}
