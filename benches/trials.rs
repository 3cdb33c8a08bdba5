//! What other constants of the estimate and of steps would do: `cargo bench --bench trials`. With
//! `-- --write` it writes its table into docs/benchmarks.md.
//!
//! Each trial renders the five views `bench-*` with one constant of the shaders changed, in turns with
//! the shaders as they are.

use std::sync::Arc;

use anyhow::{Context, Result};
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Plan};
use conemarch::preset;
use conemarch::scene::Assets;
use publish::publish;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = ["<!-- trials -->", "<!-- /trials -->"];
const PRESETS: [&str; 5] = [
    "bench-far",
    "bench-graze",
    "bench-inside",
    "bench-outside",
    "bench-thin",
];
const ORBIT: (&str, &str) = (
    "wgsl/formula/orbit.wgsl",
    include_str!("../wgsl/formula/orbit.wgsl"),
);
const STEPS: (&str, &str) = (
    "wgsl/scene/distance.wgsl",
    include_str!("../wgsl/scene/distance.wgsl"),
);
/// What is changed: a word, its file, the constant, its value, and other values.
const TRIALS: [(&str, (&str, &str), &str, &str, &[&str]); 6] = [
    (
        "iterations that are followed by the Jacobian",
        ORBIT,
        "ORBIT_PREFIX",
        "3u",
        &["1u", "2u", "4u", "6u"],
    ),
    (
        "ball that is tried, in radii of the last one",
        STEPS,
        "DISTANCE_TRIAL",
        "1.5",
        &["1.1", "1.25", "2.0"],
    ),
    (
        "least step of a ray, in thresholds",
        STEPS,
        "DISTANCE_LEAST",
        "0.1",
        &["0.0", "0.05", "0.2", "0.5"],
    ),
    (
        "smoothing of the relaxation",
        STEPS,
        "DISTANCE_SMOOTHING",
        "0.3",
        &["0.1", "0.5", "1.0"],
    ),
    (
        "largest relaxation",
        STEPS,
        "DISTANCE_MOST_RELAXED",
        "3.0",
        &["1.0", "1.5", "2.0", "5.0"],
    ),
    (
        "least gain of a cone's step, in radii",
        STEPS,
        "DISTANCE_ENOUGH",
        "0.8",
        &["0.5", "0.65", "0.9"],
    ),
];
/// Warm runs of each, in turns, of which the median of the ratios is taken.
const RUNS: usize = 9;

/// The text of a shader file with another value of a constant.
fn changed(text: &str, constant: &str, value: &str) -> String {
    let lines = text.lines().map(|line| {
        let declares = format!("const {constant} =");
        match line {
            line if line.starts_with(&declares) => format!("{declares} {value};\n"),
            // The host gives its value, so it stays.
            line if line.starts_with("override ") => format!("{line}\n"),
            line if text.contains(&declares) => format!("{line}\n"),
            line => format!("{}\n", line.replace(constant, value)),
        }
    });
    lines.collect()
}

fn render(renderer: &mut Renderer, plan: &Plan) -> Result<Frame> {
    let extras = Extras {
        depth_only: true,
        ..Extras::default()
    };
    Ok(renderer.render(plan, &Assets::default(), extras, &mut |_| true)?)
}

/// The share of pixels whose depth differs by more than two footprints.
fn moved(plan: &Plan, frame: &Frame, other: &Frame) -> f64 {
    let grain = plan.view().finest().grain;
    let pairs = frame.depth.iter().zip(&other.depth);
    let differs = |(a, b): &(&f32, &f32)| {
        let near = f64::from(a.min(**b));
        a != b && f64::from((*a - *b).abs()) > 2.0 * grain * near
    };
    pairs.filter(differs).count() as f64 / frame.depth.len() as f64
}

fn main() -> Result<()> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let mut plans = Vec::new();
    for name in PRESETS {
        let mut plan = preset::load(name, &[])?.plan.one_sample();
        // Cones have their part in every view.
        plan.march.coarsest = Some(16);
        plans.push(plan);
    }
    let mut usual = Renderer::new(Device::open(adapter)?);
    let mut rows = Vec::new();
    for (what, (file, text), constant, now, values) in TRIALS {
        for value in values {
            eprintln!("{constant} {value}");
            let text = changed(text, constant, value);
            let mut other = Renderer::new(Device::open(adapter)?);
            other.sources = Some(Arc::new(move |path| (path == file).then(|| text.clone())));
            let (mut log, mut off) = (0.0, 0.0);
            for plan in &plans {
                let mut ratios = Vec::new();
                for run in 0..=RUNS {
                    let [a, b] = [render(&mut usual, plan)?, render(&mut other, plan)?];
                    // The first run compiles.
                    if run == 0 {
                        off += moved(plan, &a, &b) / plans.len() as f64;
                    } else {
                        ratios.push(b.march_ms / a.march_ms);
                    }
                }
                ratios.sort_by(f64::total_cmp);
                log += ratios[RUNS / 2].ln() / plans.len() as f64;
            }
            let [now, value] = [now, value].map(|v| v.trim_end_matches('u'));
            rows.push(format!(
                "{what} | {now} | {value} | {:.2} | {:.3}",
                log.exp(),
                100.0 * off
            ));
        }
    }
    let table = markdown::table(
        "constant | value | instead | time, mean of the views | pixels that move by 2 footprints, %",
        "lr",
        rows,
    );
    publish("benchmarks.md", MARKS, &table)
}
