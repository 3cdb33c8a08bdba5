//! From how many rays on a cone map pays: `cargo bench --bench few_rays`. With `-- --write` it writes
//! its table into docs/heightfields.md.
//!
//! Each picture has one sample for each pixel. It is rendered by `walk`, which first makes its cone map,
//! and by `max-mip`, which needs none, in turns. The programs are warm.

use std::time::Instant;

use anyhow::Result;
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::plan::Extras;
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use median::median;
use publish::publish;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/median.rs"]
mod median;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = ["<!-- few-rays -->", "<!-- /few-rays -->"];
/// Samples of the heights of each preset here.
const SAMPLES: f64 = 512.0 * 512.0;
const PRESETS: [&str; 4] = ["bricks", "stones", "terrain", "valley-mist"];
const TRACERS: [&str; 2] = ["walk", "max-mip"];
/// Rays for each sample of the heights.
const RAYS: [f64; 6] = [0.5, 1.0, 2.0, 3.0, 4.0, 6.0];
/// Runs that a median is taken of, after one that warms.
const RUNS: usize = 5;

fn main() -> Result<()> {
    let mut executors = Vec::new();
    for _ in TRACERS {
        let (executor, who) = Executor::open(&Choice::Auto)?;
        eprintln!("measuring on {who}");
        executors.push(executor);
    }
    let mut rows = Vec::new();
    for name in PRESETS {
        eprintln!("{name}");
        let mut row = name.to_string();
        for rays in RAYS {
            let mut times = [vec![], vec![]];
            for run in 0..=RUNS {
                for (nth, tracer) in TRACERS.iter().enumerate() {
                    let set = Override::read(&format!("scene.tracer={tracer}"))?;
                    let mut plan = preset::load(name, &[set])?.plan.one_sample();
                    // Heights and maps are made anew.
                    let assets = Assets::default();
                    let pixels = rays * SAMPLES;
                    let height = (pixels * 9.0 / 16.0).sqrt();
                    plan.size = [(pixels / height) as u32, height as u32];
                    let begun = Instant::now();
                    let made =
                        executors[nth].picture(&plan, &assets, Extras::default(), &mut |_| true)?;
                    let ms = 1e3 * begun.elapsed().as_secs_f64();
                    drop(made);
                    if run > 0 {
                        times[nth].push(ms);
                    }
                }
            }
            let [walk, without] = times.map(median);
            row += &format!(" | {:.2}", walk / without);
        }
        rows.push(row);
    }
    let heads: Vec<String> = RAYS.iter().map(|rays| format!("{rays}")).collect();
    let table = markdown::table(
        &format!("preset, by rays for each sample | {}", heads.join(" | ")),
        "lrrrrrr",
        rows,
    );
    publish("heightfields.md", MARKS, &table)
}
