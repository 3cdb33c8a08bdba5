//! Every preset on a hardware GPU: `cargo bench --bench hardware [-- [--write] [--size WxH] [PRESET...]]`.
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

#[path = "common/markdown.rs"]
#[allow(dead_code, reason = "other programs use the rest")]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

const SIZE: [u32; 2] = [1920, 1080];
/// Warm runs that a median is taken of. A GPU takes some runs to reach its clock.
const RUNS: usize = 31;
const WARM: usize = 10;
/// What is compared, and the changes of the preset.
const PLANS: [&[&str]; 3] = [
    &["march.mode=ray-relaxed", "march.clip=on"],
    &[],
    &["march.coarsest=16"],
];

/// The method that the program chooses.
const CHOSEN: usize = 1;

/// A preset's times on the device, in milliseconds.
struct Row {
    name: String,
    /// March and trace of each plan.
    marched: [f64; 3],
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

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn row(executor: &mut Executor, name: &str, size: [u32; 2]) -> Result<Row> {
    let mut plans: Vec<Plan> = Vec::new();
    for changes in PLANS {
        let changes: Result<Vec<_>, _> = changes.iter().map(|c| Override::read(c)).collect();
        let mut plan = preset::load(name, &changes?)?.plan.one_sample();
        plan.size = size;
        plans.push(plan);
    }
    let extras = Extras {
        time: true,
        unread: true,
        ..Extras::default()
    };
    let assets = Assets::default();
    let (mut marched, mut colored, mut frames) = ([const { Vec::new() }; 3], vec![], vec![]);
    for run in 0..WARM + RUNS {
        // What comes first may find a card that has slowed down.
        let mut turns: Vec<_> = plans.iter().zip(&mut marched).enumerate().collect();
        if run % 2 == 1 {
            turns.reverse();
        }
        for (nth, (plan, marched)) in turns {
            let begun = Instant::now();
            let frame = executor.render(plan, &assets, extras, &mut |_: &_| true)?;
            if run < WARM {
                continue;
            }
            if nth == CHOSEN {
                colored.push(on_device(&frame, false)?);
                frames.push(begun.elapsed().as_secs_f64() * 1e3);
            }
            marched.push(on_device(&frame, true)?);
        }
    }
    Ok(Row {
        name: name.into(),
        marched: marched.map(median),
        colored: median(colored),
        frame: median(frames),
    })
}

fn table(rows: &[Row]) -> String {
    let head = "preset | rival, ms | safe, ms | with cones, ms | rival / safe | with cones / safe | colour, ms | frame, ms";
    let lines = rows.iter().map(|row| {
        let [rival, safe, cones] = row.marched;
        let times = format!("{rival:.2} | {safe:.2} | {cones:.2}");
        let ratios = format!("{:.2} | {:.2}", rival / safe, cones / safe);
        format!(
            "{} | {times} | {ratios} | {:.2} | {:.1}",
            row.name, row.colored, row.frame
        )
    });
    markdown::table(head, "lr", lines)
}

fn main() -> Result<()> {
    let mut size = SIZE;
    let mut names = Vec::new();
    let mut args = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--size" => {
                let text = args.next().context("--size needs WxH")?;
                let (w, h) = text.split_once('x').context("--size needs WxH")?;
                size = [w.parse()?, h.parse()?];
            }
            "--write" => {}
            _ if arg.starts_with('-') => bail!("unknown option {arg}"),
            _ => names.push(arg),
        }
    }
    let is_usual = names.is_empty() && size == SIZE;
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
    let device = if writes {
        Choice::Hardware
    } else {
        Choice::Auto
    };
    let (mut executor, who) = Executor::open(&device)?;
    let mut rows = Vec::new();
    for name in &names {
        eprintln!("{name}");
        rows.push(row(&mut executor, name, size)?);
    }
    println!("{} x {} on {who}:\n", size[0], size[1]);
    let marks = ["<!-- hardware -->", "<!-- /hardware -->"];
    publish::publish("benchmarks.md", marks, &table(&rows))
}
