//! The tracers for distant views beside the cone walk, over finer and finer maps.
//!
//! One camera sees the terrain of a preset, made of more and more samples of rough ground. The
//! rows tell the steps of rays with and without cones, the times, and how the pictures differ
//! from that of the walk.

use anyhow::Result;
use conemarch::base::outcome::State;
use conemarch::command::executor::Executor;
use conemarch::cpu;
use conemarch::gpu::adapters::Choice;
use conemarch::measure::compare::quantile;
use conemarch::picture::frame::Frame;
use conemarch::plan::march::Mode;
use conemarch::plan::{Extras, Plan};
use conemarch::scene::Assets;
use serde::{Deserialize, Serialize};

use crate::frames::{WIDTH, frame_ms, skipped, terrain};
use crate::median::median;

/// Samples along either axis.
const SAMPLES: [u32; 4] = [512, 1024, 2048, 4096];
const SIZE: [u32; 2] = [640, 360];
/// Factor on the distance of the preset's eye, so that the whole block is in the picture.
const AWAY: f64 = 1.6;
/// The others are compared with the first.
const TRACERS: [&str; 3] = ["walk", "walk-mip", "cone-mip"];
/// Warm runs, of which the median is taken.
const RUNS: usize = 7;
const DEPTHS: Extras = Extras {
    count: false,
    normals: false,
    variance: false,
    levels: false,
    depth_only: true,
    time: false,
    shown: false,
    sketched: false,
    unread: false,
    reuse: false,
    rays: None,
    held: false,
};
const COUNTED: Extras = Extras {
    count: true,
    ..DEPTHS
};

/// One tracer over one map.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct DistanceRow {
    /// Samples of the map along either axis.
    pub samples: u32,
    /// Width of a pixel in the middle, in texels.
    pub texels: f64,
    /// Name of the tracer.
    pub tracer: String,
    /// Mean steps of the rays that take any, without cones before them.
    pub alone: f64,
    /// The same after cones.
    pub after_cones: f64,
    /// Median time on the device over that of the walk, without cones.
    pub of_walk: f64,
    /// Share of the pixels that are skipped (see [`skipped`]).
    pub skipped: f64,
    /// Share of the pixels with ground in one picture but not in the walk's, or the reverse.
    pub in_one: f64,
    /// Differences of the depths elsewhere, in pixel widths: the median and the 95th percentile.
    pub apart: [f64; 2],
}

/// Measures all tracers over all maps.
pub fn measure() -> Result<Vec<DistanceRow>> {
    let (mut executor, _) = Executor::open(&Choice::Auto)?;
    let mut rows = Vec::new();
    for samples in SAMPLES {
        let mut plans = TRACERS
            .into_iter()
            .map(|tracer| Ok((plan(samples, tracer)?, Assets::default())))
            .collect::<Result<Vec<(Plan, Assets)>>>()?;
        let mut times = vec![Vec::new(); TRACERS.len()];
        for run in 0..=RUNS {
            for ((plan, assets), times) in plans.iter().zip(&mut times) {
                let frame = executor.render(plan, assets, DEPTHS, &mut |_| true)?;
                // The first run makes maps and compiles.
                if run > 0 {
                    times.push(frame_ms(&frame));
                }
            }
        }
        let mut counted = |mode| -> Result<Vec<Frame>> {
            let one = |(plan, assets): &mut (Plan, Assets)| {
                plan.march.mode = mode;
                cpu::render(plan, assets, COUNTED, &mut |_| true)
            };
            Ok(plans.iter_mut().map(one).collect::<Result<_, _>>()?)
        };
        let after_cones = counted(Mode::Safe)?;
        let alone = counted(Mode::Ray)?;
        let walk = &plans[0].0;
        let view = walk.view();
        let far = (walk.camera.eye - walk.camera.target).length();
        let texel = WIDTH / f64::from(samples - 1);
        for (i, tracer) in TRACERS.into_iter().enumerate() {
            let (in_one, apart) = differences(walk, &alone[0], &alone[i]);
            let ratios = times[i].iter().zip(&times[0]).map(|(own, walk)| own / walk);
            rows.push(DistanceRow {
                samples,
                texels: view.pixel * far / texel,
                tracer: tracer.into(),
                alone: steps(&alone[i]),
                after_cones: steps(&after_cones[i]),
                of_walk: median(ratios.collect()),
                skipped: skipped(&alone[i], &alone[0], texel),
                in_one,
                apart: [0.5, 0.95].map(|q| quantile(&apart, q)),
            });
        }
    }
    Ok(rows)
}

/// The preset's terrain with so many samples, seen from farther away.
fn plan(samples: u32, tracer: &str) -> Result<Plan> {
    let mut plan = terrain(&[
        format!("scene.field=\"fbm:{samples}x{samples},seed=5,power=2.6\""),
        format!("scene.tracer={tracer}"),
    ])?;
    plan.size = SIZE;
    plan.camera.eye = plan.camera.target + AWAY * (plan.camera.eye - plan.camera.target);
    Ok(plan)
}

/// Mean steps of the rays that take any.
fn steps(frame: &Frame) -> f64 {
    let taken = frame.work.iter().map(|w| f64::from(w.evaluations));
    let some: Vec<f64> = taken.filter(|n| *n > 0.0).collect();
    some.iter().sum::<f64>() / some.len().max(1) as f64
}

/// The share of pixels that are hits in one frame only, and the sorted differences of depth of
/// the others in pixel widths.
fn differences(plan: &Plan, a: &Frame, b: &Frame) -> (f64, Vec<f64>) {
    let hit = |f: &Frame, i: usize| f.state[i] == State::Hit as u8;
    let count = a.state.len();
    let one = (0..count).filter(|i| hit(a, *i) != hit(b, *i)).count();
    let ground = (0..count).filter(|i| hit(a, *i) || hit(b, *i)).count();
    let grain = plan.view().view_ray([0, 0]).grain;
    let both = (0..count).filter(|i| hit(a, *i) && hit(b, *i));
    let mut apart: Vec<f64> = both
        .map(|i| f64::from(a.depth[i] - b.depth[i]).abs() / f64::from(a.depth[i]) / (2.0 * grain))
        .collect();
    apart.sort_by(f64::total_cmp);
    (one as f64 / ground.max(1) as f64, apart)
}
