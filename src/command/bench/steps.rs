//! `conemarch bench steps`: the work of every pass, counted cell by cell.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use clap::builder::TypedValueParser;

use crate::base::outcome::{Counts, State};
use crate::command::arguments::words;
use crate::command::bench::common::{Common, Subject, of_how_many};
use crate::command::bench::runner::{COUNTED, RUNS, Runner, TIMED, median_of};
use crate::command::bench::setting::{Setting, baselines};
use crate::command::bench::steps_row::StepsRow;
use crate::command::bench::table;
use crate::command::executor::Executor;
use crate::command::interrupt;
use crate::gpu::RenderError;
use crate::measure::compare::quantile;
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
    #[arg(long, value_name = "MODE", value_parser = modes())]
    mode: Option<Mode>,
    /// Draw a heat map of evaluations for every preset and mode into this folder
    #[arg(long, value_name = "FOLDER")]
    heat: Option<PathBuf>,
}

fn modes() -> impl TypedValueParser<Value = Mode> {
    words(Mode::ALL.map(|mode| (mode, mode.name(), mode.about())))
}

/// Runs the measurement.
///
/// # Errors
/// An unknown preset or mode, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &StepsBench) -> Result<()> {
    interrupt::listen();
    // Without a mode the rival and all modes but the truth, which takes long.
    let of_one = |mode| vec![Setting::of(mode)];
    let settings = args.mode.map_or_else(baselines, of_one);
    // Kept until the end: a folder that was made is removed again if it stays empty.
    let _folder = args.heat.as_deref().map(Folder::prepare).transpose()?;
    let mut all = args.common.begin(None)?;
    let mut rows = Vec::new();
    for subject in &all.subjects {
        let fitting = settings.iter();
        let fitting = fitting.filter_map(|s| Some((s.name(), s.apply(&subject.plan)?)));
        let fitting: Vec<(&str, Plan)> = fitting.collect();
        let count = fitting.len();
        for (i, (mode, plan)) in fitting.into_iter().enumerate() {
            let what = format!("{}, {}", subject.what, of_how_many(mode, i, count));
            let name = subject.name.clone();
            let one = Subject { name, plan, what };
            let (measured, frame) = measure(&mut all.executor, &all.assets, &one, mode)?;
            all.files.show(&table::levels(&measured))?;
            rows.extend(measured);
            if let Some(folder) = &args.heat {
                let Subject { name, plan, .. } = &one;
                let file = folder.join(format!("{name}-{mode}.png"));
                let mut place = Place::prepare(&file)?;
                let shades = Shades::new(Layer::Steps, &frame, plan);
                let text = preset::write_beside(plan, &file);
                place.write(|to| write_png(to, &shades, BitDepth::Eight, &plan.title, &text))?;
                all.files.results.add(place);
            }
        }
    }
    all.files.write(&rows)
}

/// The passes of one plan, and the frame that was counted.
fn measure(
    executor: &mut Executor,
    assets: &Assets,
    subject: &Subject,
    mode: &str,
) -> Result<(Vec<StepsRow>, Frame), RenderError> {
    let plan = &subject.plan;
    let mut runner = Runner::new(executor, assets, &subject.what, RUNS + 2);
    let frame = runner.render(plan, COUNTED, "counting")?;
    let mut times: Vec<[Vec<f64>; 2]> = vec![Default::default(); frame.passes.len()];
    for run in 0..=RUNS {
        let warm = runner.render(plan, TIMED, "timing")?;
        for (pass, [wall, gpu]) in warm.marched().zip(&mut times) {
            if run > 0 {
                wall.push(pass.wall_ms);
                gpu.extend(pass.gpu_ms);
            }
        }
    }
    drop(runner);
    let mut rows = Vec::new();
    for (at, (pass, [mut wall, mut gpu])) in frame.marched().zip(times).enumerate() {
        let (work, states, width) = match frame.levels.get(at) {
            Some(level) => (&level.work, &level.state, level.cells[0]),
            None => (&frame.work, &frame.state, frame.size[0]),
        };
        rows.push(StepsRow {
            preset: subject.name.clone(),
            mode: mode.into(),
            pass: pass.pass.name(),
            size: plan.size,
            device: executor.name(),
            wall_ms: median_of(&mut wall).unwrap_or(0.0),
            gpu_ms: median_of(&mut gpu),
            precision: executor.precision_warning(plan),
            ..count(work, states, width as usize)
        });
    }
    Ok((rows, frame))
}

/// The figures of one pass's cells.
fn count(work: &[Counts], states: &[u8], width: usize) -> StepsRow {
    let spent = work.iter().map(|w| w.evaluations);
    let mut spent: Vec<u32> = spent.filter(|n| *n > 0).collect();
    spent.sort_unstable();
    let cells = work.len();
    let share = |state: State| {
        let n = states.iter().filter(|s| **s == state as u8).count();
        n as f64 / cells.max(1) as f64
    };
    // 1, 2, 3-4, 5-8 ...: the power of two that holds n.
    let bin = |n: u32| 1 + n.next_power_of_two().ilog2() as usize;
    let mut histogram = vec![0; spent.last().map_or(1, |most| bin(*most) + 1)];
    histogram[0] = (cells - spent.len()) as u64;
    for n in &spent {
        histogram[bin(*n)] += 1;
    }
    StepsRow {
        cells: cells as u64,
        visited: spent.len() as u64,
        evaluations: work.iter().map(|w| u64::from(w.evaluations)).sum(),
        iterations: work.iter().map(|w| u64::from(w.iterations)).sum(),
        p50: quantile(&spent, 0.5),
        p90: quantile(&spent, 0.9),
        p99: quantile(&spent, 0.99),
        max: quantile(&spent, 1.0),
        sky: share(State::Sky),
        unconverged: share(State::Unconverged),
        waste_8x1: waste(work, width, [8, 1]),
        waste_8x4: waste(work, width, [8, 4]),
        histogram,
        ..StepsRow::default()
    }
}

/// Evaluations of tiles whose lanes all run until the last one is done, over those that the
/// lanes need. Lanes past the edge of the level idle too.
fn waste(work: &[Counts], width: usize, tile: [usize; 2]) -> f64 {
    let height = work.len().checked_div(width).unwrap_or(0);
    let needed = |cell: usize| u64::from(work[cell].evaluations);
    let mut spent = 0;
    for y in (0..height).step_by(tile[1]) {
        for x in (0..width).step_by(tile[0]) {
            let rows = (y..(y + tile[1]).min(height)).map(|y| y * width);
            let cells = rows.flat_map(|row| row + x..row + (x + tile[0]).min(width));
            spent += cells.map(needed).max().unwrap_or(0) * (tile[0] * tile[1]) as u64;
        }
    }
    let needed: u64 = (0..work.len()).map(needed).sum();
    spent as f64 / needed.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_counted() {
        let of = |n: u32| Counts {
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
        // Of two rows of 8 lanes, one waits for ten and one for two.
        assert!((row.waste_8x1 - 2.4).abs() < 1e-12);
    }
}
