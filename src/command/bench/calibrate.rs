//! `conemarch bench calibrate`: the fastest settings of a preset that lose no more than a given
//! share of its pixels.

use anyhow::Result;
use clap::Args;
use serde::Serialize;

use crate::base::outcome::State;
use crate::command::arguments::whole;
use crate::command::bench::common::{Common, Subject};
use crate::command::bench::runner::{COUNTED, Runner, TIMED};
use crate::command::bench::table;
use crate::command::executor::Executor;
use crate::command::interrupt;
use crate::command::progress::Reporter;
use crate::gpu::RenderError;
use crate::measure::calibrate::{Calibration, calibrate};
use crate::plan::Plan;
use crate::plan::march::Mode;
use crate::scene::Assets;

/// Options of `bench calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateBench {
    #[command(flatten)]
    common: Common,
    /// Share of pixels that may be lost: too deep by over 2 footprints (half a pixel's width), sky
    /// in place of a hit, or out of steps
    #[arg(long, value_name = "SHARE", default_value_t = 0.002, value_parser = share)]
    budget: f64,
    /// Number of camera rays that probe the preset
    #[arg(long, value_name = "COUNT", default_value_t = 8192)]
    #[arg(value_parser = whole(100_u32, 1_000_000))]
    rays: u32,
}

fn share(text: &str) -> Result<f64, String> {
    let read: Option<f64> = text.parse().ok().filter(|x| (0.0..=0.5).contains(x));
    read.ok_or_else(|| "must be a share of pixels from 0 to 0.5, like 0.002".into())
}

/// One preset.
#[derive(Clone, Debug, Serialize)]
struct CalibrateRow {
    preset: String,
    size: [u32; 2],
    device: String,
    budget: f64,
    rays: usize,
    #[serde(flatten)]
    found: Calibration,
    /// Share of the probed pixels that the device loses.
    lost_on_device: f64,
    safe_evaluations_per_pixel: f64,
    evaluations_per_pixel: f64,
    safe_ms: f64,
    wall_ms: f64,
    /// A warning if f32 is not precise enough for the preset.
    precision: Option<String>,
}

/// Runs the probes.
///
/// # Errors
/// An unknown preset, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &CalibrateBench) -> Result<()> {
    interrupt::listen();
    let mut all = args.common.begin(None)?;
    let mut rows = Vec::new();
    for subject in &all.subjects {
        let mut progress = Reporter::start(&format!("calibrating {}", subject.what));
        let watch = &mut |share| progress.report(share, "");
        let rays = args.rays as usize;
        let found = calibrate(&subject.plan, &all.assets, args.budget, rays, watch)?;
        drop(progress);
        let row = measure(&mut all.executor, &all.assets, subject, found, args.budget)?;
        all.files.show(&sentence(&row, &subject.plan))?;
        rows.push(row);
    }
    all.files.write(&rows)
}

/// Measures the proposal on the device, and `safe` for comparison.
fn measure(
    executor: &mut Executor,
    assets: &Assets,
    subject: &Subject,
    found: Calibration,
    budget: f64,
) -> Result<CalibrateRow, RenderError> {
    /// Warm runs that the shortest time is taken of.
    const RUNS: usize = 4;
    let plan = &subject.plan;
    let (device, precision) = (executor.name(), executor.precision_warning(plan));
    let mut runner = Runner::new(executor, assets, &subject.what, 2 * (RUNS + 1));
    let mut safe = plan.clone();
    safe.march.mode = Mode::Safe;
    let calibrated = found.apply(plan);
    let mut work = [0.0; 2];
    let mut time = [f64::INFINITY; 2];
    let mut lost = 0;
    for (i, plan) in [&safe, &calibrated].into_iter().enumerate() {
        let mode = plan.march.mode.name();
        let frame = runner.render(plan, COUNTED, mode)?;
        work[i] = frame.work_per_pixel().map_or(0.0, |w| w.0);
        for _ in 0..RUNS {
            time[i] = time[i].min(runner.render(plan, TIMED, mode)?.march_ms);
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
        preset: subject.name.clone(),
        size: plan.size,
        device,
        budget,
        rays: found.probes.len(),
        lost_on_device: lost as f64 / found.probes.len().max(1) as f64,
        found,
        safe_evaluations_per_pixel: work[0],
        evaluations_per_pixel: work[1],
        safe_ms: time[0],
        wall_ms: time[1],
        precision,
    })
}

/// The result as text, with the lines to write into the preset.
fn sentence(row: &CalibrateRow, plan: &Plan) -> String {
    let [w, h] = row.size;
    let budget = 100.0 * row.budget;
    let verdict = match row.found.within {
        true => String::new(),
        false => {
            format!("\nNo tested settings keep the budget of {budget:.3} %. These come nearest.\n")
        }
    };
    let fudge: Vec<String> = row.found.fudge.iter().map(|f| format!("{f}")).collect();
    let precision = table::precision(row.precision.as_deref());
    let mut text = format!(
        "\n### {}, {w} x {h}, {} rays\n\n{precision}The distance estimate changes by at most {:.3} per unit of distance. The true distance is {:.1}\ntimes the estimate in the median. The settings below lose {:.3} % of the rays in f64, and {:.3} %\non the device. They take {:.2} evaluations per pixel (mode `safe` takes {:.2}) and {:.1} ms of wall\ntime (`safe` takes {:.1}).\n{verdict}\n",
        row.preset,
        row.rays,
        row.found.slope,
        row.found.slack,
        100.0 * row.found.lost,
        100.0 * row.lost_on_device,
        row.evaluations_per_pixel,
        row.safe_evaluations_per_pixel,
        row.wall_ms,
        row.safe_ms,
    );
    if row.found.lipschitz > plan.scene.lipschitz() {
        text += &format!("    [scene]\n    lipschitz = {}\n", row.found.lipschitz);
    }
    text += &format!(
        "    [march]\n    mode = \"calibrated\"\n    shell = {}\n    fudge = [{}]\n",
        row.found.shell,
        fudge.join(", ")
    );
    if row.wall_ms >= row.safe_ms {
        text += "\n`safe` is no slower here; keep it.\n";
    }
    text
}
