//! `conemarch bench error`: run time against error, setting by setting, on one device.
//!
//! Every setting of a preset is compared with the preset's truth, and timed in turn with
//! the others, so that a machine whose speed drifts slows all of them alike.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;
use glam::DVec3;

use crate::command::bench::common::{Common, median};
use crate::command::bench::row::{DepthError, Row, TruthNote, flat};
use crate::command::bench::setting::{Setting, baselines, sweeps};
use crate::command::bench::{plot, table};
use crate::command::executor::Executor;
use crate::command::failure::usage;
use crate::command::interrupt;
use crate::command::print::say;
use crate::command::sink::is_stdout;
use crate::gpu::RenderError;
use crate::measure::compare::compare;
use crate::measure::flip::{Picture, flip};
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
    /// Move single settings too: coarsest level, shell, relaxation, steps, fudge, detail
    #[arg(long)]
    sweep: bool,
    /// Draw time against error; - is standard output, and the tables go to stderr then
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
}

/// Warm runs that a median is taken of.
const RUNS: usize = 5;

/// Runs the measurement.
///
/// # Errors
/// An unknown preset, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &ErrorBench) -> Result<()> {
    interrupt::listen();
    let assets = Assets::default();
    let plans = args.common.plans(&assets)?;
    if let Some(path) = &args.plot
        && !is_svg(path)
    {
        return Err(usage(format!(
            "--plot draws an SVG, and `{}` does not end in .svg; - would be standard output",
            path.display()
        )));
    }
    let mut files = args.common.files(args.plot.as_deref(), &plans)?;
    let mut executor = args.common.executor()?;
    let cache = Cache::user();
    let mut settings = baselines();
    if args.sweep {
        settings.extend(sweeps());
    }
    let mut rows = Vec::new();
    for (name, plan) in &plans {
        let measured = measure(
            &mut executor,
            cache.as_ref(),
            name,
            plan,
            &assets,
            &settings,
        )?;
        files.show(&table::preset(&measured))?;
        rows.extend(measured);
    }
    files.show(&table::means(&rows))?;
    files.show(&table::better_than_safe(&rows))?;
    files.show(&table::slides(&rows))?;
    files.draw(|| plot::draw(&rows))?;
    let flat: Vec<_> = rows.iter().map(flat).collect();
    files.write(&rows, &flat)
}

/// Whether a name is one for an SVG, or standard output's.
fn is_svg(path: &Path) -> bool {
    let ending = path.extension().and_then(|e| e.to_str());
    is_stdout(path) || ending.is_some_and(|e| e.eq_ignore_ascii_case("svg"))
}

/// Truths by what they are asked for: settings that change the hit rule have their own.
struct Truths<'a> {
    cache: Option<&'a Cache>,
    assets: &'a Assets,
    name: &'a str,
    found: HashMap<u64, Truth>,
}

impl Truths<'_> {
    fn of(&mut self, plan: &Plan) -> Result<&Truth, RenderError> {
        let key = plan.march.detail.to_bits();
        if !self.found.contains_key(&key) {
            let watch = &mut |_: &_| !interrupt::asked();
            let (truth, kept) = cached(self.cache, plan, self.assets, watch)?;
            say(&format!(
                "{}: truth{} at {} of the estimate, {:.4} % of pixels still move",
                self.name,
                if kept { ", kept from before," } else { "" },
                truth.stride,
                100.0 * truth.moved
            ));
            self.found.insert(key, truth);
        }
        Ok(&self.found[&key])
    }
}

/// All settings of one preset.
fn measure(
    executor: &mut Executor,
    cache: Option<&Cache>,
    name: &str,
    plan: &Plan,
    assets: &Assets,
    settings: &[Setting],
) -> Result<Vec<Row>, RenderError> {
    let watch = &mut |_: &_| !interrupt::asked();
    let mut truths = Truths {
        cache,
        assets,
        name,
        found: HashMap::new(),
    };
    let fitting: Vec<(&Setting, Plan)> = settings
        .iter()
        .filter_map(|s| Some((s, s.apply(plan)?)))
        .collect();
    let mut rows = Vec::new();
    for (setting, plan) in &fitting {
        let truth = truths.of(plan)?;
        let extras = Extras {
            count: true,
            levels: true,
            ..Extras::default()
        };
        let frame = executor.render(plan, assets, extras, watch)?;
        let mut row = blank(name, plan, setting, &frame, truth, executor);
        row.fill(&compare(&frame, &truth.frame, plan, &plan.solid(assets)?));
        row.flip = look_apart(&truth.frame, &frame, plan);
        rows.push(row);
    }
    let extras = Extras {
        depth_only: true,
        time: true,
        ..Extras::default()
    };
    let mut times: Vec<[Vec<f64>; 2]> = vec![Default::default(); rows.len()];
    for run in 0..=RUNS {
        for ((_, plan), [wall, gpu]) in fitting.iter().zip(&mut times) {
            let frame = executor.render(plan, assets, extras, watch)?;
            // The first round warms up: programs without counters are new.
            if run > 0 {
                wall.push(frame.march_ms);
                let each = frame.marched();
                gpu.extend(each.map(|p| p.gpu_ms).sum::<Option<f64>>());
            }
        }
    }
    for (row, [mut wall, mut gpu]) in rows.iter_mut().zip(times) {
        row.wall_ms = median(&mut wall).unwrap_or(0.0);
        row.gpu_ms = median(&mut gpu);
    }
    Ok(rows)
}

/// How far two frames of a plan look apart.
fn look_apart(reference: &Frame, frame: &Frame, plan: &Plan) -> f64 {
    let [one, two] = [reference, frame].map(|frame| {
        let shades = Shades::new(Layer::Color, frame, plan);
        (0..frame.state.len())
            .map(|i| shades.at(i).clamp(DVec3::ZERO, DVec3::ONE))
            .collect::<Vec<_>>()
    });
    let picture = |pixels| Picture {
        size: plan.size,
        pixels,
    };
    flip(picture(&one), picture(&two))
}

/// A row without times and errors yet.
fn blank(
    name: &str,
    plan: &Plan,
    setting: &Setting,
    frame: &Frame,
    truth: &Truth,
    executor: &Executor,
) -> Row {
    let work = frame.work_per_pixel().unwrap_or((0.0, 0.0));
    Row {
        preset: name.into(),
        mode: setting.mode.name().into(),
        parameters: setting.parameters(),
        baseline: setting.changes.is_empty(),
        size: plan.size,
        device: executor.name(),
        wall_ms: 0.0,
        gpu_ms: None,
        evaluations_per_pixel: work.0,
        iterations_per_pixel: work.1,
        depth_error: DepthError::default(),
        behind: 0.0,
        front: 0.0,
        behind8: 0.0,
        front8: 0.0,
        holes: 0.0,
        false_hits: 0.0,
        start_violations: Vec::new(),
        unconverged: 0.0,
        flip: 0.0,
        truth: TruthNote {
            stride: truth.stride,
            moved: truth.moved,
        },
        precision: executor.precision_warning(plan),
    }
}
