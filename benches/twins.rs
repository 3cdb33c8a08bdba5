//! How far the GPU's pictures are from those of the CPU executor:
//! `cargo bench --bench twins [-- [--software] [--write] [PRESET...]]`. With `--write` it writes its table
//! into docs/accuracy.md. With presets it prints these alone. It takes a minute with a large GPU and 16
//! cores. `--software` has a table of its own, in which both executors choose the same march: half an hour
//! on two cores.

use anyhow::{Context, Result};
use conemarch::base::srgb::LUMA;
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
const SOFTWARE_MARKS: [&str; 2] = ["<!-- twins-software -->", "<!-- /twins-software -->"];
/// Sizes of quick light and of light by paths, and the samples of paths.
const QUICK: [u32; 2] = [480, 270];
const PATHS: ([u32; 2], u32) = ([96, 54], 16);
/// A discrete GPU has no cones unless they are asked for, and the CPU executor has them. Both are asked
/// for the same.
const CONES: [u32; 2] = [1, 16];

fn main() -> Result<()> {
    let adapters = Adapters::find();
    let in_software = std::env::args().any(|a| a == "--software");
    let device = match in_software {
        true => Choice::Software,
        false => Choice::Auto,
    };
    let chosen = adapters.choose(&device)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let on = adapter.get_info().name;
    let mut renderer = Renderer::new(Device::open(adapter)?);
    let assets = Assets::default();
    let extras = Extras {
        variance: true,
        ..Extras::default()
    };
    let mut on_gpu = |plan: &Plan| renderer.render(plan, &assets, extras, &mut |_| true);
    let on_cpu = |plan: &Plan| cpu::render(plan, &assets, extras, &mut |_| true);
    let named: Vec<_> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with("--"))
        .collect();
    let mut rows = Vec::new();
    for (name, _) in BUILTIN {
        if !named.is_empty() && !named.iter().any(|one| one == name) {
            continue;
        }
        eprintln!("{name}");
        let own = preset::load(name, &[])?.plan;
        let mut quick = own.clone();
        (quick.size, quick.samples, quick.until) = (QUICK, 1, 0.0);
        quick.look.mode = LightMode::Quick;
        let looks =
            |gpu: &Frame, cpu: &Frame| flip(QUICK, &shown(&quick, cpu), &shown(&quick, gpu));
        let mut cells = vec![name.to_string()];
        let coarsest = if in_software { &[][..] } else { &CONES };
        for &coarsest in coarsest {
            let mut plan = quick.clone();
            plan.march.coarsest = Some(coarsest);
            cells.push(format!("{:.4}", looks(&on_gpu(&plan)?, &on_cpu(&plan)?)));
        }
        for samples in [1, 16] {
            let plan = Plan {
                samples,
                ..quick.clone()
            };
            cells.push(format!("{:.4}", looks(&on_gpu(&plan)?, &on_cpu(&plan)?)));
        }
        let mut paths = own;
        (paths.size, paths.samples, paths.until) = (PATHS.0, PATHS.1, 0.0);
        (paths.look.mode, paths.march.coarsest) = (LightMode::Path, Some(1));
        let frames = [on_gpu(&paths)?, on_cpu(&paths)?];
        cells.push(format!("{:.2}", of_means(&frames)));
        cells.extend([0, 1, 2].map(|channel| format!("{:.2}", apart(&frames, channel))));
        rows.push(cells.join(" | "));
    }
    let (flips, marks) = match in_software {
        true => ("FLIP | 16 samples", SOFTWARE_MARKS),
        false => (
            "FLIP, rays alone | with cones | as chosen | as chosen, 16 samples",
            MARKS,
        ),
    };
    let head = format!(
        "preset | {flips} | paths, standard errors of the means | of the difference: red | green | blue"
    );
    let table = markdown::table(&head, "lr", rows);
    if !named.is_empty() {
        println!("{table}");
        return Ok(());
    }
    publish("accuracy.md", marks, &format!("Made on {on}.\n\n{table}"))
}

/// The pixels of a file.
fn shown(plan: &Plan, frame: &Frame) -> Vec<DVec3> {
    let tone = Tone::of(&plan.look);
    let light = frame.radiance.iter();
    light
        .map(|c| tone.shown(DVec3::from(c.map(f64::from))))
        .collect()
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

/// The difference of the mean luminances, in standard errors of a difference of two independent means.
fn of_means(frames: &[Frame; 2]) -> f64 {
    let [one, two] = frames.each_ref().map(|frame| {
        let light = frame.radiance.iter();
        light
            .map(|c| LUMA.dot(DVec3::from(c.map(f64::from))))
            .sum::<f64>()
    });
    let variances = frames.iter().flat_map(|frame| &frame.variance);
    (one - two) / variances.map(|v| f64::from(*v)).sum::<f64>().sqrt()
}
