//! Cones over the pixels of heightfields, against rays alone: `cargo bench --bench field_cones`.
//! With `-- --write` it writes its table into docs/heightfields.md.
//!
//! Each preset is traced by rays alone, as it is, and with cones from 1/16 on, in turns.

use anyhow::Result;
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::plan::Extras;
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use publish::publish;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

/// Warm runs that a median is taken of.
const RUNS: usize = 7;
const MARKS: [&str; 2] = ["<!-- field-cones -->", "<!-- /field-cones -->"];
const PRESETS: [&str; 8] = [
    "bricks",
    "map-kinds",
    "spikes",
    "stones",
    "terrain",
    "tiles-deep",
    "tiles-shallow",
    "valley-mist",
];
/// Rays alone, the preset as it is, and cones.
const PLANS: [&[&str]; 3] = [&["march.coarsest=1"], &[], &["march.coarsest=16"]];

fn main() -> Result<()> {
    // Each plan has its own, which keeps its buffers.
    let mut executors = Vec::new();
    for _ in PLANS {
        let (executor, who) = Executor::open(&Choice::Auto)?;
        eprintln!("measuring on {who}");
        executors.push(executor);
    }
    let (mut rows, mut logs) = (Vec::new(), 0.0);
    for name in PRESETS {
        eprintln!("{name}");
        let assets = Assets::default();
        let mut times = [vec![], vec![], vec![]];
        let mut evaluations = [0.0; 3];
        for run in 0..RUNS + 2 {
            for (nth, changes) in PLANS.iter().enumerate() {
                let size = ["image.size=[1280, 720]"];
                let all = size.iter().chain(*changes).map(|s| Override::read(s));
                let all: Result<Vec<_>, _> = all.collect();
                let plan = preset::load(name, &all?)?.plan.one_sample();
                // The first run counts, and the second compiles.
                let extras = Extras {
                    depth_only: true,
                    count: run == 0,
                    ..Extras::default()
                };
                let frame = executors[nth].render(&plan, &assets, extras, &mut |_| true)?;
                if run > 1 {
                    times[nth].push(frame.march_ms);
                } else if run == 0 {
                    let passes = frame.passes.iter().filter_map(|p| p.evaluations);
                    evaluations[nth] = passes.sum::<u64>() as f64 / frame.state.len() as f64;
                }
            }
        }
        let [rays, own, cones] = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        });
        logs += (own / rays).ln() / PRESETS.len() as f64;
        let [few, _, many] = evaluations;
        rows.push(format!(
            "{name} | {rays:.0} | {own:.0} | {cones:.0} | {:.2} | {:.2} | {few:.1} | {many:.1}",
            own / rays,
            cones / rays
        ));
    }
    rows.push(format!("geometric mean | | | | {:.2} | | |", logs.exp()));
    let table = markdown::table(
        "march and trace, 1280 x 720 | rays alone, ms | preset, ms | cones, ms | preset / rays | cones / rays | steps per pixel, rays | cones",
        "lr",
        rows,
    );
    publish("heightfields.md", MARKS, &table)
}
