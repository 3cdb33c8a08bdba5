//! Times of whole frames by cone map, at 32 and 200 steps: the tables of section 4.1 of Valasek
//! and Ban (2022), at the sizes of the paper.

use crate::median::median;
use anyhow::{Context, Result, ensure};
use conemarch::base::outcome::State;
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use serde::{Deserialize, Serialize};

/// Warm runs, of which the median is taken.
const RUNS: usize = 5;
/// Limits of steps of a ray, as in the paper.
const STEPS: [u32; 2] = [32, 200];
/// Length of the block's side in the preset `terrain`.
pub const WIDTH: f64 = 12.0;
/// Cells along it.
const TEXELS: f64 = 511.0;

/// One map with one refinement, at one limit of steps.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FrameRow {
    /// Name in the paper; empty if it has none.
    pub paper: String,
    /// Name of the tracer.
    pub tracer: String,
    /// Generator of the map; `none` for none.
    pub map: String,
    /// Most steps of a ray.
    pub steps: u32,
    /// Median time of trace and colour, in milliseconds.
    pub ms: f64,
    /// Median, run by run, of its time over that of the first map at the same limit.
    pub of_first: f64,
    /// Share of the pixels that ran out of steps.
    pub unconverged: f64,
    /// Share of the pixels that are skipped (see [`skipped`]).
    pub skipped: f64,
}

/// Name in the paper, tracer, map, and rounds of refinement: one of false positions, or five
/// halvings.
const KINDS: [(&str, &str, &str, &str); 7] = [
    ("BFCM", "secant", "exact", "1"),
    ("RCMs", "secant", "relaxed-search", "1"),
    ("RCMb", "rcs-binary", "relaxed-search", "5"),
    ("QI", "secant", "improved", "1"),
    ("QC", "secant", "center", "1"),
    ("", "max-mip", "none", "auto"),
    ("", "walk", "walk", "auto"),
];

/// The preset `terrain` with other settings, rendered without cones.
pub fn terrain(settings: &[String]) -> Result<Plan> {
    let always = [format!("scene.width={WIDTH}"), "march.mode=ray".into()];
    let all = always.iter().chain(settings).map(|s| Override::read(s));
    let all: Vec<Override> = all.collect::<Result<_, _>>()?;
    Ok(preset::load("terrain", &all)?.plan.one_sample())
}

/// The plan of a kind, without shadows, as the papers' shaders are.
fn plan(field: &str, relaxed: &str, kind: (&str, &str, &str, &str), steps: u32) -> Result<Plan> {
    let (_, tracer, map, rounds) = kind;
    let map = match map {
        "none" => "auto",
        "relaxed-search" => relaxed,
        own => own,
    };
    terrain(&[
        format!("scene.field={field:?}"),
        format!("scene.tracer={tracer}"),
        format!("scene.map={map:?}"),
        format!("scene.tracer_rounds={rounds}"),
        format!("scene.tracer_steps={steps}"),
        // Tracers without a limit of their own stop there.
        format!("march.steps={steps}"),
        "look.shadow=false".into(),
        "look.occlusion=0".into(),
        "image.size=[1920, 1080]".into(),
    ])
}

/// Wall time of all passes in milliseconds.
pub fn frame_ms(frame: &Frame) -> f64 {
    frame.passes.iter().map(|p| p.wall_ms).sum()
}

/// Share of the pixels that are skipped: they show a hit over a texel behind that of the truth,
/// or sky where the truth has a hit. The truth is the frame of the walk.
pub fn skipped(frame: &Frame, truth: &Frame, texel: f64) -> f64 {
    let state = |f: &Frame, i: usize| State::from_code(f.state[i].into());
    let behind = |i: &usize| {
        let past = f64::from(frame.depth[*i] - truth.depth[*i]) > texel;
        let own = state(frame, *i);
        let lost = own == Some(State::Sky) || own == Some(State::Hit) && past;
        lost && state(truth, *i) == Some(State::Hit)
    };
    let count = (0..frame.state.len()).filter(behind).count();
    count as f64 / frame.state.len().max(1) as f64
}

/// Renders all kinds in turn, so that a busy machine slows all of them alike.
pub fn measure(field: &str, relaxed: &str) -> Result<Vec<FrameRow>> {
    let (mut executor, _) = Executor::open(&Choice::Auto)?;
    let mut render = |(plan, assets): &(Plan, Assets)| {
        executor.render(plan, assets, Extras::default(), &mut |_| true)
    };
    // The assets of a plan keep its maps from run to run.
    let ready = |kind, steps| -> Result<(Plan, Assets)> {
        Ok((plan(field, relaxed, kind, steps)?, Assets::default()))
    };
    let truth = render(&ready(KINDS[KINDS.len() - 1], 1024)?)?;
    ensure!(truth.census()[2] == 0, "the walk did not converge");
    let mut rows = Vec::new();
    for steps in STEPS {
        let plans = KINDS.map(|kind| ready(kind, steps));
        let plans = plans.into_iter().collect::<Result<Vec<_>>>()?;
        let mut times = vec![Vec::new(); KINDS.len()];
        let mut frames = Vec::new();
        for run in 0..=RUNS {
            frames = plans.iter().map(&mut render).collect::<Result<_, _>>()?;
            // The first run makes maps and compiles.
            if run > 0 {
                for (times, frame) in times.iter_mut().zip(&frames) {
                    times.push(frame_ms(frame));
                }
            }
        }
        for (i, (paper, tracer, map, _)) in KINDS.into_iter().enumerate() {
            let ratios = times[i]
                .iter()
                .zip(&times[0])
                .map(|(own, first)| own / first);
            let frame: &Frame = frames.get(i).context("a frame")?;
            rows.push(FrameRow {
                paper: paper.into(),
                tracer: tracer.into(),
                map: map.into(),
                steps,
                ms: median(times[i].clone()),
                of_first: median(ratios.collect()),
                unconverged: frame.census()[2] as f64 / frame.state.len().max(1) as f64,
                skipped: skipped(frame, &truth, WIDTH / TEXELS),
            });
        }
    }
    Ok(rows)
}
