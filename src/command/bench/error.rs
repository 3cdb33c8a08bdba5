//! `conemarch bench error`: run time against error, setting by setting, on one device.
//!
//! Every setting of a preset is compared with the preset's truth. The settings are timed in
//! turn, so that a machine whose speed drifts slows all of them alike.

use std::collections::HashMap;
use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use glam::DVec3;

use crate::command::bench::common::{Common, Subject, of_how_many};
use crate::command::bench::row::Row;
use crate::command::bench::runner::{COUNTED, RUNS, Runner, TIMED, median_of};
use crate::command::bench::setting::{Setting, baselines, sweeps};
use crate::command::bench::{plot, table};
use crate::command::executor::Executor;
use crate::command::failure::usage;
use crate::command::interrupt;
use crate::command::print::say;
use crate::command::progress::Reporter;
use crate::command::sink::{ending, is_stdout};
use crate::gpu::RenderError;
use crate::measure::compare::compare;
use crate::measure::flip::flip;
use crate::measure::sharpness::{self, SetSample, sharpness};
use crate::measure::truth::{Cache, Truth, cached};
use crate::picture::frame::Frame;
use crate::picture::{Layer, Shades};
use crate::plan::{Extras, Plan};
use crate::scene::Assets;

/// Options of `bench error`.
#[derive(Debug, Args)]
pub struct ErrorBench {
    #[command(flatten)]
    common: Common,
    /// Also measure other values of march.coarsest, shell, relaxation, steps, fudge, detail and
    /// scene.lipschitz, one at a time
    #[arg(long)]
    sweep: bool,
    /// Draw time against error; - is standard output, and the tables then go to stderr
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
}

/// Runs the measurement.
///
/// # Errors
/// An unknown preset, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &ErrorBench) -> Result<()> {
    interrupt::listen();
    if let Some(path) = &args.plot
        && !(is_stdout(path) || ending(path) == "svg")
    {
        return Err(usage(format!(
            "--plot draws an SVG, and `{}` does not end in .svg; - is standard output",
            path.display()
        )));
    }
    let mut all = args.common.begin(args.plot.as_deref())?;
    let cache = Cache::user();
    let mut settings = baselines();
    if args.sweep {
        settings.extend(sweeps());
    }
    let mut rows = Vec::new();
    for subject in &all.subjects {
        let fitting = settings.iter();
        let fitting = fitting.filter_map(|s| Some((s, s.apply(&subject.plan)?)));
        let fitting: Vec<(&Setting, Plan)> = fitting.collect();
        let truths = truths(cache.as_ref(), &all.assets, subject, &fitting)?;
        let stride = truths[&truth_key(&subject.plan)].note.stride;
        let mut progress = Reporter::start("sampling the shape");
        progress.report(0.0, &subject.what);
        let set = sharpness::sample(&subject.plan, &all.assets, stride)?;
        drop(progress);
        let references = (&truths, &set);
        let measured = measure(
            &mut all.executor,
            &all.assets,
            subject,
            &fitting,
            references,
        )?;
        all.files.show(&table::preset(&measured))?;
        rows.extend(measured);
    }
    all.files.show(&table::means(&rows))?;
    all.files.show(&table::better_than_safe(&rows))?;
    all.files.show(&table::slides(&rows))?;
    if let Some(sink) = all.files.plot.take() {
        all.files.results.put(sink, plot::draw(&rows).as_bytes())?;
    }
    all.files.write(&rows)
}

/// Truths by what settings change of the hit rule: `march.detail`, and whether the estimate is the
/// sharpest.
type Truths = HashMap<(u64, bool), Truth>;

fn truth_key(plan: &Plan) -> (u64, bool) {
    let sharpest = plan.scene.sharpest();
    let is_sharpest = sharpest.is_none_or(|scene| scene == plan.scene);
    (plan.march.detail.to_bits(), is_sharpest)
}

/// The truths of all settings of one preset.
fn truths(
    cache: Option<&Cache>,
    assets: &Assets,
    subject: &Subject,
    settings: &[(&Setting, Plan)],
) -> Result<Truths, RenderError> {
    let mut found = Truths::new();
    let Subject { name, what, .. } = subject;
    for (_, plan) in settings {
        if found.contains_key(&truth_key(plan)) {
            continue;
        }
        let mut progress = Reporter::start(&format!("rendering the truth of {what}"));
        let (truth, is_cached) = cached(cache, plan, assets, &mut progress.watch())?;
        drop(progress);
        let kept = if is_cached { ", kept from before," } else { "" };
        let (stride, moved) = (truth.note.stride, 100.0 * truth.note.moved);
        say(&format!(
            "{name}: truth{kept} at {stride} of the estimate, {moved:.4} % of pixels still move"
        ));
        found.insert(truth_key(plan), truth);
    }
    Ok(found)
}

/// All settings of one preset.
fn measure(
    executor: &mut Executor,
    assets: &Assets,
    subject: &Subject,
    settings: &[(&Setting, Plan)],
    (truths, set): (&Truths, &SetSample),
) -> Result<Vec<Row>, RenderError> {
    let device = executor.name();
    let precision = executor.precision_warning(&subject.plan);
    let all = settings.len();
    let mut runner = Runner::new(executor, assets, &subject.what, all * (RUNS + 2));
    let counted = Extras {
        depth_only: false,
        ..COUNTED
    };
    let detail = |i: usize, setting: &Setting| of_how_many(setting.name(), i, all);
    let mut rows = Vec::new();
    for (i, (setting, plan)) in settings.iter().enumerate() {
        let truth = &truths[&truth_key(plan)];
        let frame = runner.render(plan, counted, &detail(i, setting))?;
        let work = frame.work_per_pixel().unwrap_or((0.0, 0.0));
        rows.push(Row {
            preset: subject.name.clone(),
            mode: setting.mode.name().into(),
            parameters: setting.parameters(),
            baseline: i < baselines().len(),
            size: plan.size,
            device: device.clone(),
            evaluations_per_pixel: work.0,
            iterations_per_pixel: work.1,
            report: compare(
                &frame,
                &truth.frame,
                plan,
                &plan.scene.solid(&plan.viewpoint(), assets)?,
            ),
            flip: look_apart(&truth.frame, &frame, plan),
            sharpness: sharpness(&frame, set, plan),
            truth: truth.note,
            precision: precision.clone(),
            // Times follow below.
            ..Row::default()
        });
    }
    let mut times: Vec<[Vec<f64>; 2]> = vec![Default::default(); rows.len()];
    for run in 0..=RUNS {
        for (i, ((setting, plan), [wall, gpu])) in settings.iter().zip(&mut times).enumerate() {
            let frame = runner.render(plan, TIMED, &detail(i, setting))?;
            // The first round warms up: programs without counters are new.
            if run > 0 {
                wall.push(frame.march_ms);
                gpu.extend(frame.marched().map(|p| p.gpu_ms).sum::<Option<f64>>());
            }
        }
    }
    for (row, [mut wall, mut gpu]) in rows.iter_mut().zip(times) {
        row.wall_ms = median_of(&mut wall).unwrap_or(0.0);
        row.gpu_ms = median_of(&mut gpu);
    }
    Ok(rows)
}

/// How far two frames of a plan look apart.
fn look_apart(reference: &Frame, frame: &Frame, plan: &Plan) -> f64 {
    let [one, two] = [reference, frame].map(|frame| {
        let shades = Shades::new(Layer::Color, frame, plan);
        let shown = (0..frame.state.len()).map(|i| shades.at(i).clamp(DVec3::ZERO, DVec3::ONE));
        shown.collect::<Vec<_>>()
    });
    flip(plan.size, &one, &two)
}
