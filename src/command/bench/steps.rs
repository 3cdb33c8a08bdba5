//! `conemarch bench steps`: the work of every pass, counted cell by cell.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;

use crate::base::work::{State, Work};
use crate::command::bench::common::{Common, median_of};
use crate::command::bench::runner::{COUNTED, RUNS, Runner, TIMED, of_how_many};
use crate::command::bench::setting::{Setting, baselines};
use crate::command::bench::steps_row::StepsRow;
use crate::command::bench::table;
use crate::command::executor::Executor;
use crate::command::failure::usage;
use crate::command::interrupt;
use crate::gpu::RenderError;
use crate::picture::frame::Frame;
use crate::picture::{BitDepth, Folder, Layer, Place, Shades, write_png};
use crate::plan::Plan;
use crate::plan::march::Mode;
use crate::preset;
use crate::scene::Assets;

/// Options of `bench steps`.
#[derive(Debug, Args)]
pub struct StepsBench {
    #[command(flatten)]
    common: Common,
    /// Only this mode
    #[arg(long, value_name = "MODE")]
    mode: Option<String>,
    /// Draw a heat map of evaluations for every preset and mode into this folder
    #[arg(long, value_name = "FOLDER")]
    heat: Option<PathBuf>,
}

/// Runs the measurement.
///
/// # Errors
/// An unknown preset or mode, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &StepsBench) -> Result<()> {
    interrupt::listen();
    let assets = Assets::default();
    let plans = args.common.plans(&assets)?;
    let settings = modes(args.mode.as_deref())?;
    // Kept until the end: a folder that was made is removed again if it stays empty.
    let _folder = args.heat.as_deref().map(Folder::prepare).transpose()?;
    let mut files = args.common.files(None, &plans)?;
    let mut executor = args.common.executor()?;
    let mut rows = Vec::new();
    for (i, (name, plan)) in plans.iter().enumerate() {
        let fitting: Vec<Plan> = settings.iter().filter_map(|s| s.apply(plan)).collect();
        for (j, plan) in fitting.iter().enumerate() {
            let mode = of_how_many(plan.march.mode.name(), j, fitting.len());
            let what = format!("{}, {mode}", of_how_many(name, i, plans.len()));
            let (measured, frame) = measure(&mut executor, &assets, name, &what, plan)?;
            files.show(&table::levels(&measured))?;
            rows.extend(measured);
            if let Some(folder) = &args.heat {
                let file = format!("{name}-{}.png", plan.march.mode.name());
                let mut place = Place::prepare(&folder.join(file))?;
                let shades = Shades::new(Layer::Steps, &frame, plan);
                let text = preset::write(plan);
                place.write(|to| write_png(to, &shades, BitDepth::Eight, &plan.title, &text))?;
                files.parcel.add(place);
            }
        }
    }
    files.write(&rows)
}

/// The mode of a name; without a name all modes but the truth, which takes long.
fn modes(name: Option<&str>) -> Result<Vec<Setting>> {
    let Some(name) = name else {
        return Ok(baselines());
    };
    if let Some(mode) = Mode::named(name) {
        return Ok(vec![Setting::of(mode)]);
    }
    let names = Mode::ALL.map(Mode::name).join(", ");
    Err(usage(format!(
        "there is no mode `{name}`; the modes are {names}"
    )))
}

/// The passes of one plan, and the frame that was counted.
fn measure(
    executor: &mut Executor,
    assets: &Assets,
    name: &str,
    what: &str,
    plan: &Plan,
) -> Result<(Vec<StepsRow>, Frame), RenderError> {
    let mut runner = Runner::new(executor, assets, what, RUNS + 2);
    let frame = runner.render(plan, COUNTED, "counting")?;
    let mut times: Vec<[Vec<f64>; 2]> = vec![Default::default(); frame.passes.len()];
    for run in 0..=RUNS {
        let warm = runner.render(plan, TIMED, "timing")?;
        let passes = warm.marched();
        for (pass, [wall, gpu]) in passes.zip(&mut times) {
            if run > 0 {
                wall.push(pass.wall_ms);
                gpu.extend(pass.gpu_ms);
            }
        }
    }
    drop(runner);
    let mut rows = Vec::new();
    let passes = frame.marched();
    for (at, (pass, [mut wall, mut gpu])) in passes.zip(times).enumerate() {
        let (work, states, width) = match frame.levels.get(at) {
            Some(level) => (&level.work, &level.state, level.cells[0]),
            None => (&frame.work, &frame.state, frame.size[0]),
        };
        let row = count(work, states, width as usize);
        rows.push(StepsRow {
            preset: name.into(),
            mode: plan.march.mode.name().into(),
            pass: pass.pass.name(),
            size: plan.size,
            device: executor.name(),
            wall_ms: median_of(&mut wall).unwrap_or(0.0),
            gpu_ms: median_of(&mut gpu),
            precision: executor.precision_warning(plan),
            ..row
        });
    }
    Ok((rows, frame))
}

/// The figures of one pass's cells.
fn count(work: &[Work], states: &[u8], width: usize) -> StepsRow {
    let mut spent: Vec<u32> = work
        .iter()
        .map(|w| w.evaluations)
        .filter(|n| *n > 0)
        .collect();
    spent.sort_unstable();
    let quantile = |q: f64| {
        let last = spent.len().saturating_sub(1) as f64;
        spent.get((q * last).round() as usize).copied().unwrap_or(0)
    };
    let cells = work.len();
    let share = |state: State| {
        let n = states.iter().filter(|s| **s == state as u8).count();
        n as f64 / cells.max(1) as f64
    };
    let mut histogram = vec![(cells - spent.len()) as u64];
    for n in &spent {
        // 1, 2, 3-4, 5-8 ...: the power of two that holds n.
        let bin = 1 + n.next_power_of_two().ilog2() as usize;
        if histogram.len() <= bin {
            histogram.resize(bin + 1, 0);
        }
        histogram[bin] += 1;
    }
    StepsRow {
        cells: cells as u64,
        visited: spent.len() as u64,
        evaluations: work.iter().map(|w| u64::from(w.evaluations)).sum(),
        iterations: work.iter().map(|w| u64::from(w.iterations)).sum(),
        p50: quantile(0.5),
        p90: quantile(0.9),
        p99: quantile(0.99),
        max: quantile(1.0),
        sky: share(State::Sky),
        unconverged: share(State::Unconverged),
        waste_8x4: waste(work, width, [8, 4]),
        waste_8x8: waste(work, width, [8, 8]),
        histogram,
        ..StepsRow::default()
    }
}

/// Evaluations of tiles whose lanes all run until the last one is done, over those that the
/// lanes need. Lanes past the edge of the level idle too.
fn waste(work: &[Work], width: usize, tile: [usize; 2]) -> f64 {
    let height = work.len().checked_div(width).unwrap_or(0);
    let (mut needed, mut spent) = (0_u64, 0_u64);
    for y in (0..height).step_by(tile[1]) {
        for x in (0..width).step_by(tile[0]) {
            let rows = (y..(y + tile[1]).min(height)).map(|y| y * width);
            let cells = rows.flat_map(|row| row + x..row + (x + tile[0]).min(width));
            let mut longest = 0;
            for cell in cells {
                let n = u64::from(work[cell].evaluations);
                needed += n;
                longest = longest.max(n);
            }
            spent += longest * (tile[0] * tile[1]) as u64;
        }
    }
    spent as f64 / needed.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_counted() {
        let of = |n: u32| Work {
            evaluations: n,
            iterations: 10 * n,
        };
        // A level of 9 x 2 cells, the ninth column under sky.
        let mut work = vec![of(2); 18];
        (work[8], work[17], work[3]) = (of(0), of(0), of(10));
        let mut states = vec![State::Hit as u8; 18];
        (states[8], states[17], states[3]) = (0, 0, State::Unconverged as u8);
        let row = count(&work, &states, 9);
        assert_eq!((row.cells, row.visited), (18, 16));
        assert_eq!((row.evaluations, row.iterations), (40, 400));
        assert_eq!((row.p50, row.p90, row.p99, row.max), (2, 2, 10, 10));
        assert_eq!(row.histogram, [2, 0, 15, 0, 0, 1]);
        assert!((row.sky - 2.0 / 18.0).abs() < 1e-12);
        assert!((row.unconverged - 1.0 / 18.0).abs() < 1e-12);
        // The first tile of 32 lanes waits for ten evaluations, the second for none.
        assert!((row.waste_8x4 - 8.0).abs() < 1e-12);
        assert!((row.waste_8x8 - 16.0).abs() < 1e-12);
    }
}
