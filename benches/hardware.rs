//! Every preset on a hardware GPU:
//! `cargo bench --bench hardware [-- [--software] [--write] [--size WxH] [PRESET...]]`. With `--software`
//! it has a table of its own, at a smaller size. With `--software --rival` it compares nothing but the rival
//! and `safe`, in more runs and at the usual size, for differences of a few per cent.
//!
//! The rival (mode `ray-relaxed` with `clip` on), the method that the program chooses and `safe` with
//! cones render in turns, forwards and backwards. The times are the device's own, medians of warm runs, with one sample per
//! pixel. Layers stay on the device: a card that waits for a reader would lower its clock.

use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Pass, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use median::median;

#[path = "common/markdown.rs"]
#[allow(dead_code, reason = "other programs use the rest")]
mod markdown;
#[path = "common/median.rs"]
mod median;
#[path = "common/publish.rs"]
mod publish;

const SIZE: [u32; 2] = [1920, 1080];
const SOFTWARE_SIZE: [u32; 2] = [1280, 720];
/// Warm runs that a median is taken of, and runs before. A GPU takes some runs to reach its clock.
const RUNS: [usize; 2] = [31, 10];
const SOFTWARE_RUNS: [usize; 2] = [5, 1];
const RIVAL_RUNS: [usize; 2] = [11, 1];
/// What is compared, and the changes of the preset.
const PLANS: [&[&str]; 4] = [
    &["march.mode=ray-relaxed", "march.clip=on"],
    &[],
    &["march.coarsest=16"],
    // In software only.
    &["march.mode=proven"],
];

/// The method that the program chooses.
const CHOSEN: usize = 1;

/// A preset's times on the device, in milliseconds.
struct Row {
    name: String,
    /// March and trace of each plan.
    marched: Vec<f64>,
    /// Levels of cones of the chosen method.
    levels: usize,
    /// Colour, and a whole frame on the clock, of the chosen method.
    colored: f64,
    frame: f64,
}

/// The device's time of the passes that march, or of colour.
fn on_device(frame: &Frame, marches: bool) -> Result<f64> {
    let passes = frame.passes.iter().filter(|p| p.pass.marches() == marches);
    let times = passes
        .filter(|p| !matches!(p.pass, Pass::Prepare(_)))
        .map(|p| p.gpu_ms);
    let sum: Option<f64> = times.sum();
    sum.context("the device has no timestamps")
}

/// A preset with the first changes of [`PLANS`].
fn plans(name: &str, size: [u32; 2], count: usize) -> Result<Vec<Plan>> {
    let plan = |changes: &&[&str]| {
        let changes: Result<Vec<_>, _> = changes.iter().map(|c| Override::read(c)).collect();
        let mut plan = preset::load(name, &changes?)?.plan.one_sample();
        plan.size = size;
        Ok(plan)
    };
    PLANS[..count].iter().map(plan).collect()
}

/// The first two plans in turns. Ratios are of runs that follow each other.
fn rival_row(executors: &mut [Executor], name: &str, size: [u32; 2]) -> Result<String> {
    let [runs, warm] = RIVAL_RUNS;
    let extras = Extras {
        time: true,
        unread: true,
        depth_only: true,
        ..Extras::default()
    };
    let assets = Assets::default();
    let plans = plans(name, size, 2)?;
    let (mut times, mut ratios) = ([vec![], vec![]], vec![]);
    let mut levels = 0;
    for run in 0..warm + runs {
        let mut now = [0.0; 2];
        let order = if run % 2 == 0 { [0, 1] } else { [1, 0] };
        for nth in order {
            let executor = &mut executors[nth];
            let frame = executor.render(&plans[nth], &assets, extras, &mut |_: &_| true)?;
            now[nth] = on_device(&frame, true)?;
            if nth == CHOSEN {
                levels = frame.passes.iter().filter(|p| p.pass.marches()).count() - 1;
            }
        }
        if run >= warm {
            times[0].push(now[0]);
            times[1].push(now[1]);
            ratios.push(now[0] / now[1]);
        }
    }
    ratios.sort_by(f64::total_cmp);
    let [low, middle, high] = [runs / 4, runs / 2, runs - 1 - runs / 4].map(|at| ratios[at]);
    let [rival, safe] = times.map(median);
    Ok(format!(
        "{name} | {rival:.1} | {safe:.1} | {middle:.3} | {low:.3} to {high:.3} | {levels}"
    ))
}

/// In software each plan has an executor of its own, which keeps its buffers.
fn row(executors: &mut [Executor], name: &str, size: [u32; 2], in_software: bool) -> Result<Row> {
    let (count, [runs, warm]) = match in_software {
        true => (4, SOFTWARE_RUNS),
        false => (3, RUNS),
    };
    let plans = plans(name, size, count)?;
    let extras = Extras {
        time: true,
        unread: true,
        ..Extras::default()
    };
    let assets = Assets::default();
    let (mut marched, mut colored, mut frames) = (vec![vec![]; count], vec![], vec![]);
    let mut levels = 0;
    for run in 0..warm + runs {
        // What comes first may find a card that has slowed down.
        let mut turns: Vec<_> = plans.iter().zip(&mut marched).enumerate().collect();
        if run % 2 == 1 {
            turns.reverse();
        }
        for (nth, (plan, marched)) in turns {
            let executor = &mut executors[if in_software { nth } else { 0 }];
            let mut render = |depth_only: bool| {
                let extras = Extras {
                    depth_only,
                    ..extras
                };
                executor.render(plan, &assets, extras, &mut |_: &_| true)
            };
            let begun = Instant::now();
            let mut frame = render(in_software && nth != CHOSEN)?;
            if nth == CHOSEN {
                levels = frame.passes.iter().filter(|p| p.pass.marches()).count() - 1;
                if run >= warm {
                    colored.push(on_device(&frame, false)?);
                    frames.push(begun.elapsed().as_secs_f64() * 1e3);
                }
                // All plans are alike: what runs before a pass changes its time. The second run counts.
                if in_software {
                    render(true)?;
                    frame = render(true)?;
                }
            }
            if run >= warm {
                marched.push(on_device(&frame, true)?);
            }
        }
    }
    Ok(Row {
        name: name.into(),
        marched: marched.into_iter().map(median).collect(),
        levels,
        colored: median(colored),
        frame: median(frames),
    })
}

fn table(rows: &[Row]) -> String {
    let mut head = "preset | rival, ms | safe, ms | with cones, ms | rival / safe | with cones / safe | colour, ms | frame, ms".to_string();
    if rows.iter().any(|row| row.marched.len() > 3) {
        head += " | proven / safe | levels of cones";
    }
    let lines = rows.iter().map(|row| {
        let [rival, safe, cones] = [0, 1, 2].map(|nth| row.marched[nth]);
        let proven = row.marched.get(3).map_or(String::new(), |proven| {
            format!(" | {:.2} | {}", proven / safe, row.levels)
        });
        let times = format!("{rival:.2} | {safe:.2} | {cones:.2}");
        let ratios = format!("{:.2} | {:.2}", rival / safe, cones / safe);
        format!(
            "{} | {times} | {ratios} | {:.2} | {:.1}{proven}",
            row.name, row.colored, row.frame
        )
    });
    markdown::table(&head, "lr", lines)
}

fn main() -> Result<()> {
    let in_software = std::env::args().any(|a| a == "--software");
    let of_rival = std::env::args().any(|a| a == "--rival");
    let usual = match in_software && !of_rival {
        true => SOFTWARE_SIZE,
        false => SIZE,
    };
    let mut size = usual;
    let mut names = Vec::new();
    let mut args = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--size" => {
                let text = args.next().context("--size needs WxH")?;
                let (w, h) = text.split_once('x').context("--size needs WxH")?;
                size = [w.parse()?, h.parse()?];
            }
            "--write" | "--software" | "--rival" => {}
            _ if arg.starts_with('-') => bail!("unknown option {arg}"),
            _ => names.push(arg),
        }
    }
    let is_usual = names.is_empty() && size == usual;
    let writes = std::env::args().any(|a| a == "--write");
    ensure!(
        is_usual || !writes,
        "--write needs all presets at the usual size"
    );
    if names.is_empty() {
        names = preset::BUILTIN
            .iter()
            .map(|(name, _)| name.to_string())
            .collect();
    }
    let device = match (in_software, writes) {
        (true, _) => Choice::Software,
        (_, true) => Choice::Hardware,
        _ => Choice::Auto,
    };
    let (executor, who) = Executor::open(&device)?;
    let mut executors = vec![executor];
    let count = match (of_rival, in_software) {
        (true, _) => 2,
        (_, true) => PLANS.len(),
        _ => 1,
    };
    for _ in 1..count {
        executors.push(Executor::open(&device)?.0);
    }
    if of_rival {
        let mut rows = Vec::new();
        for name in &names {
            eprintln!("{name}");
            rows.push(rival_row(&mut executors, name, size)?);
        }
        let head = "preset | rival, ms | safe, ms | rival / safe | middle half of the ratios | levels of cones";
        println!("{} x {} on {who}:\n", size[0], size[1]);
        let marks = ["<!-- pairs -->", "<!-- /pairs -->"];
        return publish::publish("benchmarks.md", marks, &markdown::table(head, "lr", rows));
    }
    let mut rows = Vec::new();
    for name in &names {
        eprintln!("{name}");
        rows.push(row(&mut executors, name, size, in_software)?);
    }
    println!("{} x {} on {who}:\n", size[0], size[1]);
    let marks = match in_software {
        true => ["<!-- software -->", "<!-- /software -->"],
        false => ["<!-- hardware -->", "<!-- /hardware -->"],
    };
    publish::publish("benchmarks.md", marks, &table(&rows))
}
