//! Whether a small picture is the large one made small:
//! `cargo bench --bench reference [-- [--write] [--samples N] [PRESET...]]`. With `--write` it writes its
//! table into docs/accuracy.md. With presets it prints these alone. All of them take less than a minute on a
//! large GPU, and most of an hour in software. `--samples` gives the large picture more samples. It fails
//! where the difference reaches the aim.

use anyhow::{Context, Result, ensure};
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::pass::tone_map::Tone;
use conemarch::plan::Extras;
use conemarch::preset::{self, BUILTIN};
use conemarch::scene::Assets;
use filtered::apart;
use glam::DVec3;
use publish::publish;

#[path = "../tests/common/filtered.rs"]
mod filtered;
#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = ["<!-- reference -->", "<!-- /reference -->"];
/// Sizes, and samples per pixel. A pixel of the small picture covers 16 of the large one, which have
/// 512 samples together. With more, the noise and the difference would be smaller.
const LARGE: ([u32; 2], u32) = ([1280, 720], 32);
const SMALL: ([u32; 2], u32) = ([320, 180], 256);
/// The aim, of 255.
const MOST: f64 = 2.0;

fn main() -> Result<()> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let mut renderer = Renderer::new(Device::open(adapter)?);
    let (mut rows, mut beyond) = (Vec::new(), Vec::new());
    let (mut named, mut samples) = (Vec::new(), LARGE.1);
    let mut args = std::env::args().skip(1);
    while let Some(word) = args.next() {
        match word.as_str() {
            "--samples" => samples = args.next().context("--samples needs a number")?.parse()?,
            _ if word.starts_with("--") => {}
            _ => named.push(word),
        }
    }
    ensure!(
        !named.is_empty() || samples == LARGE.1,
        "--samples needs presets"
    );
    for (name, _) in BUILTIN {
        if !named.is_empty() && !named.iter().any(|one| one == name) {
            continue;
        }
        let plan = preset::load(name, &[])?.plan;
        // The others are for measurements.
        if plan.reference.is_none() {
            continue;
        }
        eprintln!("{name}");
        let [large, small] = [(LARGE.0, samples), SMALL].map(|(size, samples)| {
            let mut plan = plan.clone();
            (plan.size, plan.samples, plan.until) = (size, samples, 0.0);
            renderer.render(&plan, &Assets::default(), Extras::default(), &mut |_| true)
        });
        let (large, small) = (large?, small?);
        let tone = Tone::of(&plan.look);
        let shown = |light| tone.shown(DVec3::from_array(light)).to_array();
        let [bias, size] = apart(&small, &large, shown).map(|v| 255.0 * v);
        rows.push(format!("{name} | {size:.2} | {bias:.2}"));
        if size >= MOST {
            beyond.push(name);
        }
    }
    let table = markdown::table(
        "preset | mean difference, of 255 | mean of the signed difference, of 255",
        "lr",
        rows,
    );
    if !named.is_empty() {
        println!("{table}");
    } else {
        publish("accuracy.md", MARKS, &table)?;
    }
    ensure!(
        beyond.is_empty(),
        "{beyond:?} differ by {MOST} of 255 or more"
    );
    Ok(())
}
