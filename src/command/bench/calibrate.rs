//! `conemarch bench calibrate`: what a preset can afford, for a stated share of lost pixels.

use anyhow::Result;
use clap::Args;
use serde::Serialize;

use crate::base::work::State;
use crate::command::bench::common::Common;
use crate::command::bench::row::flat;
use crate::command::bench::table;
use crate::command::executor::Executor;
use crate::command::interrupt;
use crate::gpu::RenderError;
use crate::measure::calibrate::{Calibration, calibrate};
use crate::plan::march::Mode;
use crate::plan::{Extras, Plan};
use crate::scene::Assets;

/// Options of `bench calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateBench {
    #[command(flatten)]
    common: Common,
    /// Share of pixels that may be lost: behind, holes or unconverged
    #[arg(long, value_name = "SHARE", default_value_t = 0.002, value_parser = share)]
    budget: f64,
    /// Camera rays to probe with
    #[arg(long, value_name = "COUNT", default_value_t = 8192, value_parser = count)]
    rays: u32,
}

fn share(text: &str) -> Result<f64, String> {
    let read: Option<f64> = text.parse().ok().filter(|x| (0.0..=0.5).contains(x));
    read.ok_or_else(|| "must be a share of pixels from 0 to 0.5, like 0.002".into())
}

fn count(text: &str) -> Result<u32, String> {
    let read: Option<u32> = text.parse().ok().filter(|n| (100..=1_000_000).contains(n));
    read.ok_or_else(|| "must be a number from 100 to 1000000".into())
}

/// One preset.
#[derive(Clone, Debug, Serialize)]
struct CalibrateRow {
    preset: String,
    size: [u32; 2],
    device: String,
    budget: f64,
    rays: usize,
    slope: f64,
    slack: f64,
    lipschitz: f64,
    shell: f64,
    fudge: Vec<f64>,
    lost: f64,
    within: bool,
    /// On the device, at the probed pixels.
    lost_on_device: f64,
    safe_evaluations_per_pixel: f64,
    evaluations_per_pixel: f64,
    safe_ms: f64,
    wall_ms: f64,
    /// A warning where f32 cannot hold what the preset asks for.
    precision: Option<String>,
}

/// Runs the probes.
///
/// # Errors
/// An unknown preset, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &CalibrateBench) -> Result<()> {
    interrupt::listen();
    let assets = Assets::default();
    let plans = args.common.plans(&assets)?;
    let files = args.common.files(None, &plans)?;
    let mut executor = args.common.executor()?;
    let mut rows = Vec::new();
    for (name, plan) in &plans {
        let found = calibrate(plan, &assets, args.budget, args.rays as usize, &|| {
            !interrupt::asked()
        })?;
        let row = measure(&mut executor, name, plan, &assets, &found, args.budget)?;
        files.show(&sentence(&row, plan))?;
        rows.push(row);
    }
    let flat: Vec<_> = rows.iter().map(flat).collect();
    files.write(&rows, &flat)
}

/// The proposal on the device, beside `safe`.
fn measure(
    executor: &mut Executor,
    name: &str,
    plan: &Plan,
    assets: &Assets,
    found: &Calibration,
    budget: f64,
) -> Result<CalibrateRow, RenderError> {
    let watch = &mut |_: &_| !interrupt::asked();
    let mut safe = plan.clone();
    safe.march.mode = Mode::Safe;
    let calibrated = found.apply(plan);
    let counted = Extras {
        count: true,
        depth_only: true,
        ..Extras::default()
    };
    let timed = Extras {
        depth_only: true,
        ..Extras::default()
    };
    let mut work = [0.0; 2];
    let mut time = [f64::INFINITY; 2];
    let mut lost = 0;
    for (i, plan) in [&safe, &calibrated].into_iter().enumerate() {
        let frame = executor.render(plan, assets, counted, watch)?;
        work[i] = frame.work_per_pixel().map_or(0.0, |w| w.0);
        for _ in 0..4 {
            time[i] = time[i].min(executor.render(plan, assets, timed, watch)?.march_ms);
        }
        let width = plan.size[0] as usize;
        let gone = found.probes.iter().filter(|probe| {
            let at = probe.pixel[1] as usize * width + probe.pixel[0] as usize;
            let deep = |hit: f64| f64::from(frame.depth[at]) > hit + 2.0 * probe.grain;
            let shown = frame.state[at] == State::Hit as u8;
            probe.hit.is_some_and(|hit| !shown || deep(hit))
        });
        lost = gone.count();
    }
    Ok(CalibrateRow {
        preset: name.into(),
        size: plan.size,
        device: executor.name(),
        budget,
        rays: found.probes.len(),
        slope: found.slope,
        slack: found.slack,
        lipschitz: found.lipschitz,
        shell: found.shell,
        fudge: found.fudge.clone(),
        lost: found.lost,
        within: found.within,
        lost_on_device: lost as f64 / found.probes.len().max(1) as f64,
        safe_evaluations_per_pixel: work[0],
        evaluations_per_pixel: work[1],
        safe_ms: time[0],
        wall_ms: time[1],
        precision: executor.precision_warning(plan),
    })
}

/// What was found, and what to write into the preset.
fn sentence(row: &CalibrateRow, plan: &Plan) -> String {
    let [w, h] = row.size;
    let verdict = if row.within {
        String::new()
    } else {
        format!(
            "\nThe budget of {:.3} % is out of reach: this is the nearest that was found.\n",
            100.0 * row.budget
        )
    };
    let fudge: Vec<String> = row.fudge.iter().map(|f| format!("{f}")).collect();
    let precision = table::precision(row.precision.as_deref());
    let mut text = format!(
        "\n### {}, {w} x {h}, {} rays\n\n{precision}Largest slope {:.3}, slack {:.1} in the median. Lost {:.3} % of rays in f64, {:.3} % on the\ndevice. Evaluations per pixel {:.2}, `safe` {:.2}; {:.1} ms of wall\ntime, `safe` {:.1}.\n{verdict}\n",
        row.preset,
        row.rays,
        row.slope,
        row.slack,
        100.0 * row.lost,
        100.0 * row.lost_on_device,
        row.evaluations_per_pixel,
        row.safe_evaluations_per_pixel,
        row.wall_ms,
        row.safe_ms,
    );
    if row.lipschitz > plan.scene.lipschitz() {
        text += &format!("    [scene]\n    lipschitz = {}\n", row.lipschitz);
    }
    text += &format!(
        "    [march]\n    mode = \"calibrated\"\n    shell = {}\n    fudge = [{}]\n",
        row.shell,
        fudge.join(", ")
    );
    text
}
