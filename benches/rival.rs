//! `safe` against the strongest way without cones, at equal real sharpness:
//! `cargo bench --bench rival [-- --size WxH] [PRESET...]`.
//!
//! The *rival* is mode `ray-relaxed` with `clip` on. It has the estimate, the relaxation and the
//! bounds of `safe`, but no cones. The *old rival* has the scalar estimate. Its `detail` is lowered
//! until its picture is as sharp: it lies as far in front of the set as that of `safe`, in the median.
//! *No cones* is `safe` with rays alone: it keeps its shell, which the rivals have not.
//! Times are medians of warm runs in turns, each the second of two in a row.

use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use as_sharp::as_sharp;
use conemarch::base::outcome::Counts;
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::measure::sharpness::{self, BeforeSet, Sharpness, sharpness};
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use views::VIEWS;

#[path = "common/as_sharp.rs"]
mod as_sharp;
#[path = "common/markdown.rs"]
#[allow(dead_code, reason = "other programs use the rest")]
mod markdown;
#[path = "common/views.rs"]
mod views;

/// Warm turns that a median is taken of, at least, and for how long: short times vary more.
const TURNS: usize = 9;
const LEAST: Duration = Duration::from_secs(20);
/// The factor on the steps to the set.
const STRIDE: f64 = 0.1;
/// What is compared, and the changes of the preset.
const PLANS: [(&str, &[&str]); 5] = [
    ("rival", &["march.mode=ray-relaxed", "march.clip=on"]),
    ("safe", &[]),
    ("no cones", &["march.coarsest=1"]),
    ("proven", &["march.mode=proven"]),
    (
        "old rival",
        &[
            "march.mode=ray-relaxed",
            "march.clip=on",
            "scene.estimate=scalar",
        ],
    ),
];

/// A plan's figures.
struct Measured {
    detail: f64,
    /// March and trace on the clock.
    ms: f64,
    /// Iterations per pixel, as groups of 32 lanes pay them.
    iterations: f64,
    sharpness: Sharpness,
}

struct Bench {
    executor: Executor,
    assets: Assets,
}

impl Bench {
    fn render(&mut self, plan: &Plan, count: bool) -> Result<Frame> {
        let extras = Extras {
            count,
            levels: count,
            depth_only: true,
            ..Extras::default()
        };
        let watch = &mut |_: &_| true;
        Ok(self.executor.render(plan, &self.assets, extras, watch)?)
    }

    fn preset(&mut self, name: &str, size: [u32; 2]) -> Result<Vec<Measured>> {
        let mut plans = Vec::new();
        for (_, changes) in PLANS {
            let changes: Result<Vec<_>, _> = changes.iter().map(|c| Override::read(c)).collect();
            let mut plan = preset::load(name, &changes?)?.plan.one_sample();
            plan.size = size;
            plans.push(plan);
        }
        let set = sharpness::sample(&plans[1], &self.assets, STRIDE)?;
        let safe = sharpness(&self.render(&plans[1], false)?, &set, &plans[1]);
        let median = safe.before_set.median;
        plans[4].march.detail = as_sharp(&plans[4], &set, median, |plan| self.render(plan, false))?;
        let mut all = Vec::new();
        for plan in &plans {
            let frame = self.render(plan, true)?;
            all.push(Measured {
                detail: plan.march.detail,
                ms: 0.0,
                iterations: in_step(&frame),
                sharpness: sharpness(&frame, &set, plan),
            });
        }
        let mut times = vec![Vec::new(); plans.len()];
        let begin = Instant::now();
        let mut run = 0;
        while run <= TURNS || begin.elapsed() < LEAST {
            let mut turn: Vec<_> = plans.iter().zip(&mut times).collect();
            // What runs after another finds the processor warm or busy.
            if run % 2 == 1 {
                turn.reverse();
            }
            for (plan, times) in turn {
                // The first of two finds the caches full of another's data.
                self.render(plan, false)?;
                let ms = self.render(plan, false)?.march_ms;
                // The first round compiles.
                if run > 0 {
                    times.push(ms);
                }
            }
            run += 1;
        }
        for (measured, mut times) in all.iter_mut().zip(times) {
            times.sort_by(f64::total_cmp);
            measured.ms = times[times.len() / 2];
        }
        Ok(all)
    }
}

/// Iterations per pixel if the 32 lanes of 8 x 4 cells all wait for the last one.
fn in_step(frame: &Frame) -> f64 {
    let levels = frame.levels.iter();
    let levels = levels.map(|l| (&l.work, l.cells.map(|n| n as usize)));
    let pixels = (&frame.work, frame.size.map(|n| n as usize));
    let spent: u64 = levels
        .chain([pixels])
        .map(|(work, size)| group(work, size))
        .sum();
    spent as f64 / frame.state.len() as f64
}

fn group(work: &[Counts], [width, height]: [usize; 2]) -> u64 {
    let mut spent = 0;
    for y in (0..height).step_by(4) {
        for x in (0..width).step_by(8) {
            let rows = (y..(y + 4).min(height)).map(|y| y * width);
            let cells = rows.flat_map(|row| row + x..row + (x + 8).min(width));
            let most = cells.map(|i| work[i].iterations).max();
            spent += 32 * u64::from(most.unwrap_or(0));
        }
    }
    spent
}

fn main() -> Result<()> {
    let mut size = [1920, 1080];
    let mut names = Vec::new();
    let mut args = std::env::args().skip(1).filter(|a| a != "--bench");
    while let Some(arg) = args.next() {
        if arg == "--size" {
            let text = args.next().context("--size needs WxH")?;
            let (w, h) = text.split_once('x').context("--size needs WxH")?;
            size = [w.parse()?, h.parse()?];
        } else {
            names.push(arg);
        }
    }
    if names.is_empty() {
        names = VIEWS.map(String::from).into();
    }
    let (executor, who) = Executor::open(&Choice::Auto)?;
    eprintln!("measuring on {who}");
    let assets = Assets::default();
    let mut bench = Bench { executor, assets };
    let mut all = Vec::new();
    for name in &names {
        eprintln!("{name}, {} x {}", size[0], size[1]);
        all.push((name.clone(), bench.preset(name, size)?));
    }
    let [w, h] = size;
    println!(
        "March and trace at {w} x {h}, in milliseconds, and in shares of the time of `safe`:\n"
    );
    println!("{}", times(&all));
    println!("Iterations per pixel if each of 32 rays takes as many as the longest of them:\n");
    println!("{}", iterations(&all));
    println!("Compared with the set, each with its `detail`:\n");
    println!("{}", errors(&all));
    Ok(())
}

type Rows = [(String, Vec<Measured>)];

/// The geometric mean over the `bench-*` views of a figure's ratio to that of `safe`.
fn mean(all: &Rows, of: usize, figure: fn(&Measured) -> f64) -> f64 {
    let views = all.iter().filter(|(name, _)| name.starts_with("bench-"));
    let logs: Vec<f64> = views
        .map(|(_, m)| (figure(&m[of]) / figure(&m[1])).ln())
        .collect();
    (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp()
}

/// A figure of every plan, and its ratios to that of `safe`.
fn compared(all: &Rows, figure: fn(&Measured) -> f64, digits: usize) -> String {
    let row = |(name, m): &(String, Vec<Measured>)| {
        let own = m.iter().map(|m| format!("{:.digits$}", figure(m)));
        let ratio = |i: usize| format!("{:.2}", figure(&m[i]) / figure(&m[1]));
        let cells: Vec<String> = own.chain([0, 2, 3, 4].map(ratio)).collect();
        format!("{name} | {}", cells.join(" | "))
    };
    let means = [0, 2, 3, 4].map(|i| format!("{:.2}", mean(all, i, figure)));
    let last = format!("mean of `bench-*` | | | | | | {}", means.join(" | "));
    let head = "preset | rival | safe | no cones | proven | old rival | rival / safe | no cones / safe | proven / safe | old rival / safe";
    markdown::table(head, "lr", all.iter().map(row).chain([last]))
}

fn times(all: &Rows) -> String {
    compared(all, |m| m.ms, 0)
}

fn iterations(all: &Rows) -> String {
    compared(all, |m| m.iterations, 1)
}

fn errors(all: &Rows) -> String {
    let rows = all.iter().flat_map(|(name, measured)| {
        let of = PLANS.iter().zip(measured);
        of.map(move |((plan, _), m)| {
            let BeforeSet { median, p95 } = m.sharpness.before_set;
            let wrong = 100.0 * m.sharpness.wrong_of_set;
            let starts: u64 = m.sharpness.starts_beyond_set.iter().sum();
            let detail = m.detail;
            format!(
                "{name} | {plan} | {detail:.2} | {median:.2} | {p95:.2} | {wrong:.3} | {starts}"
            )
        })
    });
    let head = "preset | mode | detail | footprints before the set, median | 95 % | wrong pixels % | starts beyond the set";
    markdown::table(head, "llr", rows)
}
