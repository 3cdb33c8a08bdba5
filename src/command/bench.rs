//! `conemarch bench error`: run time against error, mode by mode, on one device.
//!
//! Every mode of a preset is compared with the preset's truth, and timed in turn with
//! the others, so that a machine whose speed drifts slows all of them alike.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::{Args, Subcommand};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::executor::Executor;
use super::{interrupt, print, size};
use crate::compare::{Report, compare};
use crate::gpu::device::Choice;
use crate::mode::Mode;
use crate::output::{self, Place};
use crate::plan::{Extras, Plan};
use crate::preset;
use crate::render::RenderError;
use crate::truth::truth;

/// What to measure.
#[derive(Debug, Subcommand)]
pub enum Bench {
    /// Time and error of every mode against the truth
    Error(ErrorBench),
}

/// Options of `bench error`.
#[derive(Debug, Args)]
pub struct ErrorBench {
    /// Presets; all five `bench-*` where none is named
    names: Vec<String>,
    /// Pixels, instead of the presets' own
    #[arg(long, value_name = "WxH", value_parser = size::read)]
    size: Option<[u32; 2]>,
    /// auto, gpu, software, cpu, an index or a part of a name
    #[arg(long, value_name = "DEVICE", default_value = "auto")]
    device: String,
    /// Write the rows as JSON too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Warm runs that a median is taken of.
const RUNS: usize = 5;

/// The measured settings: name, mode, whether rays are clipped against a mode's habit.
const SETTINGS: &[(&str, Mode, Option<bool>)] = &[
    ("ray", Mode::Ray, None),
    ("ray-relaxed", Mode::RayRelaxed, None),
    ("safe", Mode::Safe, None),
    ("slides-even", Mode::SlidesEven, None),
    ("slides-deep", Mode::SlidesDeep, None),
    ("slides-fast", Mode::SlidesFast, None),
    ("ray, clip on", Mode::Ray, Some(true)),
];

/// One row: a preset, a setting, its work, time and error.
#[derive(Debug, Serialize)]
struct Row {
    preset: String,
    mode: &'static str,
    parameters: Map<String, Value>,
    baseline: bool,
    size: [u32; 2],
    device: String,
    wall_ms: f64,
    gpu_ms: Option<f64>,
    evaluations_per_pixel: f64,
    iterations_per_pixel: f64,
    depth_error: Value,
    behind: f64,
    front: f64,
    behind8: f64,
    front8: f64,
    holes: f64,
    false_hits: f64,
    start_violations: Vec<u64>,
    unconverged: f64,
    flip: Option<f64>,
    #[serde(skip)]
    label: &'static str,
}

/// Runs the measurement.
///
/// # Errors
/// An unknown preset, a device that fails, an unwritable file, an interrupt.
pub fn run(bench: &Bench) -> Result<()> {
    let Bench::Error(args) = bench;
    interrupt::listen();
    let names = if args.names.is_empty() {
        preset::BUILTIN
            .iter()
            .map(|(name, _)| (*name).to_string())
            .filter(|name| name.starts_with("bench-"))
            .collect()
    } else {
        args.names.clone()
    };
    let mut plans = Vec::new();
    for name in &names {
        let mut plan = preset::load(name, &[])?.plan;
        if let Some(size) = args.size {
            plan.size = size;
        }
        plans.push((name.clone(), plan));
    }
    let place = args.json.as_deref().map(Place::prepare).transpose()?;
    let (mut executor, who) = Executor::open(&Choice::read(&args.device))?;
    eprintln!("measuring on {who}");
    let mut rows = Vec::new();
    for (name, plan) in &plans {
        let measured = measure(&mut executor, name, plan)?;
        print::print(table(&measured).as_bytes())?;
        rows.extend(measured);
    }
    print::print(summary(&rows).as_bytes())?;
    if let Some(mut place) = place {
        let text = serde_json::to_string_pretty(&rows).context("the rows cannot be written")?;
        place.write_all(text.as_bytes())?;
        output::commit(vec![place])?;
    }
    Ok(())
}

/// All settings of one preset.
fn measure(executor: &mut Executor, name: &str, plan: &Plan) -> Result<Vec<Row>, RenderError> {
    let watch = &mut |_: &_| !interrupt::asked();
    let reference = truth(plan, watch)?;
    eprintln!(
        "{name}: truth at {} of the estimate, {:.4} % of pixels still move",
        reference.stride,
        100.0 * reference.moved
    );
    let view = plan.view();
    let plans: Vec<Plan> = SETTINGS
        .iter()
        .map(|&(_, mode, clip)| {
            let mut plan = plan.clone();
            plan.march.mode = mode;
            plan.march.clip = clip.or(plan.march.clip);
            plan
        })
        .collect();
    let mut rows = Vec::new();
    for (plan, &(label, mode, clip)) in plans.iter().zip(SETTINGS) {
        let extras = Extras {
            count: true,
            levels: true,
            depth_only: true,
            time: true,
            ..Extras::default()
        };
        let frame = executor.render(plan, extras, watch)?;
        let report = compare(&frame, &reference.frame, &view);
        let work = frame.work_per_pixel().unwrap_or((0.0, 0.0));
        let mut row = row(name, plan, label, mode, &report, work);
        row.device = executor.name();
        if clip.is_some() {
            row.parameters.insert("clip".into(), json!("on"));
            row.baseline = false;
        }
        rows.push(row);
    }
    let extras = Extras {
        depth_only: true,
        time: true,
        ..Extras::default()
    };
    let mut times: Vec<[Vec<f64>; 2]> = vec![Default::default(); rows.len()];
    for run in 0..=RUNS {
        for (plan, [wall, gpu]) in plans.iter().zip(&mut times) {
            let frame = executor.render(plan, extras, watch)?;
            // The first round warms up: programs without counters are new.
            if run > 0 {
                wall.push(frame.march_ms);
                let each = frame.passes.iter().map(|p| p.gpu_ms);
                gpu.extend(each.sum::<Option<f64>>());
            }
        }
    }
    for (row, [mut wall, mut gpu]) in rows.iter_mut().zip(times) {
        row.wall_ms = median(&mut wall).unwrap_or(0.0);
        row.gpu_ms = median(&mut gpu);
    }
    Ok(rows)
}

fn row(
    name: &str,
    plan: &Plan,
    label: &'static str,
    mode: Mode,
    report: &Report,
    (evaluations, iterations): (f64, f64),
) -> Row {
    let [median, p95, p99, max] = report.depth_error;
    Row {
        preset: name.into(),
        mode: mode.name(),
        parameters: Map::new(),
        baseline: true,
        size: plan.size,
        device: String::new(),
        wall_ms: 0.0,
        gpu_ms: None,
        evaluations_per_pixel: evaluations,
        iterations_per_pixel: iterations,
        depth_error: json!({"median": median, "p95": p95, "p99": p99, "max": max}),
        behind: report.behind,
        front: report.front,
        behind8: report.behind8,
        front8: report.front8,
        holes: report.holes,
        false_hits: report.false_hits,
        start_violations: report.start_violations.iter().map(|v| v.1).collect(),
        unconverged: report.unconverged,
        flip: None,
        label,
    }
}

fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The rows of one preset, as a table that is also Markdown.
fn table(rows: &[Row]) -> String {
    let Some(first) = rows.first() else {
        return String::new();
    };
    let [w, h] = first.size;
    let mut text = format!(
        "\n### {}, {w} x {h}\n\n| mode | evaluations per pixel | fewer | ms | faster | behind % | holes % | behind 8 % | p99 footprints | unconverged % | start violations, coarse to fine |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|\n",
        first.preset
    );
    for row in rows {
        let starts: Vec<String> = row.start_violations.iter().map(u64::to_string).collect();
        text += &format!(
            "| {:<12} | {:6.2} | {:5.2} | {:7.1} | {:5.2} | {:.4} | {:.4} | {:.4} | {:8.3} | {:.4} | {} |\n",
            row.label,
            row.evaluations_per_pixel,
            first.evaluations_per_pixel / row.evaluations_per_pixel,
            row.wall_ms,
            first.wall_ms / row.wall_ms,
            100.0 * row.behind,
            100.0 * row.holes,
            100.0 * row.behind8,
            row.depth_error["p99"].as_f64().unwrap_or(0.0),
            100.0 * row.unconverged,
            starts.join(" "),
        );
    }
    text
}

/// Geometric means over presets, of each setting against `ray` and `ray-relaxed`.
fn summary(rows: &[Row]) -> String {
    let of = |label: &str| -> Vec<&Row> { rows.iter().filter(|r| r.label == label).collect() };
    let mean = |a: &[&Row], b: &[&Row], f: fn(&Row) -> f64| {
        let logs = a.iter().zip(b).map(|(a, b)| (f(a) / f(b)).ln());
        (logs.sum::<f64>() / a.len().max(1) as f64).exp()
    };
    let (ray, relaxed) = (of("ray"), of("ray-relaxed"));
    let mut text = String::from(
        "\n### Geometric means over the presets\n\n| mode | fewer evaluations than ray | than ray-relaxed | faster than ray | than ray-relaxed |\n|---|---:|---:|---:|---:|\n",
    );
    for (label, _, _) in SETTINGS {
        let own = of(label);
        let work = |r: &Row| r.evaluations_per_pixel;
        let time = |r: &Row| r.wall_ms;
        text += &format!(
            "| {label:<12} | {:5.2} | {:5.2} | {:5.2} | {:5.2} |\n",
            mean(&ray, &own, work),
            mean(&relaxed, &own, work),
            mean(&ray, &own, time),
            mean(&relaxed, &own, time),
        );
    }
    text
}
