//! How far the GPU's pictures are from those of the CPU executor: `cargo bench --bench twins`. With
//! `-- --write` it writes its table into docs/accuracy.md. It takes ten minutes on two cores.

use anyhow::{Context, Result};
use conemarch::cpu;
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::measure::flip::flip;
use conemarch::pass::tone_map::Tone;
use conemarch::picture::frame::Frame;
use conemarch::plan::look::LightMode;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{self, BUILTIN};
use conemarch::scene::Assets;
use glam::DVec3;
use publish::publish;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = ["<!-- twins -->", "<!-- /twins -->"];
/// Sizes and samples of quick light and of light by paths.
const QUICK: ([u32; 2], u32) = ([480, 270], 1);
const PATHS: ([u32; 2], u32) = ([96, 54], 16);

fn main() -> Result<()> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let name = adapter.get_info().name;
    let mut renderer = Renderer::new(Device::open(adapter)?);
    let mut both = |plan: &Plan| -> Result<[Frame; 2]> {
        let (assets, extras) = (Assets::default(), Extras::default());
        Ok([
            renderer.render(plan, &assets, extras, &mut |_| true)?,
            cpu::render(plan, &assets, extras, &mut |_| true)?,
        ])
    };
    let mut rows = Vec::new();
    for (name, _) in BUILTIN {
        eprintln!("{name}");
        let own = preset::load(name, &[])?.plan;
        let of = |(size, samples), mode| {
            let mut plan = own.clone();
            (plan.size, plan.samples, plan.until) = (size, samples, 0.0);
            plan.look.mode = mode;
            plan
        };
        let quick = of(QUICK, LightMode::Quick);
        let tone = Tone::of(&quick.look);
        let shown = both(&quick)?.map(|frame| {
            let light = frame.radiance.iter().map(|c| DVec3::from(c.map(f64::from)));
            light.map(|c| tone.shown(c)).collect::<Vec<_>>()
        });
        let flip = flip(quick.size, &shown[1], &shown[0]);
        let frames = both(&of(PATHS, LightMode::Path))?;
        let errors = [0, 1, 2].map(|channel| format!("{:.2}", apart(&frames, channel)));
        rows.push(format!("{name} | {flip:.4} | {}", errors.join(" | ")));
    }
    let table = markdown::table(
        "preset | quick light, mean FLIP | paths: red, standard errors | green | blue",
        "lr",
        rows,
    );
    publish("accuracy.md", MARKS, &format!("Made on {name}.\n\n{table}"))
}

/// The difference of the means of a channel, in standard errors. Both have the same random numbers, so
/// the error is that of the differences of pixels.
fn apart([one, two]: &[Frame; 2], channel: usize) -> f64 {
    let pairs = one.radiance.iter().zip(&two.radiance);
    let off: Vec<f64> = pairs
        .map(|(a, b)| f64::from(a[channel]) - f64::from(b[channel]))
        .collect();
    let n = off.len() as f64;
    let mean = off.iter().sum::<f64>() / n;
    let spread = off.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    mean / (spread / n).sqrt()
}
