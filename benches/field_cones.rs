//! Cones over the pixels of heightfields, against rays alone: `cargo bench --bench field_cones`.
//! With `-- --write` it writes its table into docs/heightfields.md.
//!
//! Each preset is traced by rays alone, as it is, and with cones from 1/16 on, in turns. Shaders that count
//! patches in place of steps tell how many are solved.

use std::sync::Arc;

use anyhow::{Context, Result};
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
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

const COUNT: &str = "fn count_evaluation() {";
const SOLVE: &str = "    let s = patch_hit(";

/// The shaders that count patches.
fn of_patches(path: &str) -> Option<String> {
    let counts = |text: &str| {
        assert!(text.contains(COUNT));
        text.replace(COUNT, "fn count_evaluation() {}\nfn count_patch() {")
    };
    match path {
        "wgsl/base/counters.wgsl" => Some(counts(include_str!("../wgsl/base/counters.wgsl"))),
        "wgsl/base/counters_off.wgsl" => {
            Some(counts(include_str!("../wgsl/base/counters_off.wgsl")))
        }
        "wgsl/heightfield/tracer/grid.wgsl" => {
            let text = include_str!("../wgsl/heightfield/tracer/grid.wgsl");
            assert!(text.contains(SOLVE));
            Some(text.replace(SOLVE, &format!("    count_patch();\n{SOLVE}")))
        }
        _ => None,
    }
}

/// Patches that are solved for each pixel of a preset, and the share of pixels that hit.
fn patches(renderer: &mut Renderer, name: &str) -> Result<[f64; 2]> {
    let plan = preset::load(name, &[Override::read("image.size=[1280, 720]")?])?.plan;
    let extras = Extras {
        depth_only: true,
        count: true,
        ..Extras::default()
    };
    let assets = Assets::default();
    let frame = renderer.render(&plan.one_sample(), &assets, extras, &mut |_| true)?;
    let solved = frame.passes.iter().filter_map(|p| p.evaluations);
    let hits = frame.depth.iter().filter(|t| t.is_finite()).count();
    let pixels = frame.state.len() as f64;
    Ok([solved.sum::<u64>() as f64 / pixels, hits as f64 / pixels])
}

fn main() -> Result<()> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let mut counting = Renderer::new(Device::open(adapter)?);
    counting.sources = Some(Arc::new(of_patches));
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
        let [solved, hits] = patches(&mut counting, name)?;
        rows.push(format!(
            "{name} | {rays:.0} | {own:.0} | {cones:.0} | {:.2} | {:.2} | {few:.1} | {many:.1} | {solved:.2} | {hits:.2}",
            own / rays,
            cones / rays
        ));
    }
    rows.push(format!(
        "geometric mean | | | | {:.2} | | | | |",
        logs.exp()
    ));
    let table = markdown::table(
        "march and trace, 1280 x 720 | rays alone, ms | preset, ms | cones, ms | preset / rays | cones / rays | steps per pixel, rays | cones | patches per pixel | share of hits",
        "lr",
        rows,
    );
    publish("heightfields.md", MARKS, &table)
}
