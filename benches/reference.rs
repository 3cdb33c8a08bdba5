//! Whether a small picture is the large one made small: `cargo bench --bench reference`. With
//! `-- --write` it writes its table into docs/accuracy.md, and with `-- PRESET...` it prints these
//! presets alone. A second table is of the presets whose own `image.reference` is lower than the default:
//! how far their pictures are from those with the details of the default, which large prints have. With
//! `--prints` it is the only one. All of them take a minute on a large GPU, and hours in software.

use anyhow::{Context, Result};
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::pass::tone_map::Tone;
use conemarch::picture::frame::Frame;
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
const PRINTS: [&str; 2] = ["<!-- prints -->", "<!-- /prints -->"];
/// The default of `image.reference`.
const DEFAULT: u32 = 2160;
const SAMPLES: u32 = 256;
const LARGE: [u32; 2] = [1280, 720];
const SMALL: [u32; 2] = [320, 180];

fn main() -> Result<()> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let mut renderer = Renderer::new(Device::open(adapter)?);
    let (mut rows, mut prints) = (Vec::new(), Vec::new());
    let only_prints = std::env::args().any(|word| word == "--prints");
    let named: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with("--"))
        .collect();
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
        let mut render = |size, reference: Option<u32>| {
            let mut plan = plan.clone();
            (plan.size, plan.samples, plan.until) = (size, SAMPLES, 0.0);
            plan.reference = reference;
            renderer.render(&plan, &Assets::default(), Extras::default(), &mut |_| true)
        };
        let small = render(SMALL, plan.reference)?;
        let tone = Tone::of(&plan.look);
        let shown = |light: [f64; 3]| tone.shown(DVec3::from_array(light)).to_array();
        if let Some(own) = plan.reference.filter(|own| *own < DEFAULT) {
            let fine = render(SMALL, Some(DEFAULT))?;
            let apart = same_size(&small, &fine, shown).map(|v| 255.0 * v);
            prints.push(format!(
                "{name} | {own} | {:.1} | {:.1}",
                apart[1], apart[0]
            ));
        }
        if !only_prints {
            let large = render(LARGE, plan.reference)?;
            let [bias, size] = apart(&small, &large, shown).map(|v| 255.0 * v);
            rows.push(format!("{name} | {size:.2} | {bias:.2}"));
        }
    }
    let table = markdown::table(
        "preset | mean difference, of 255 | mean of the signed difference, of 255",
        "lr",
        rows,
    );
    let prints = markdown::table(
        "preset | its reference | mean difference from 2160, of 255 | mean of the signed difference, of 255",
        "lr",
        prints,
    );
    match (named.is_empty(), only_prints) {
        (false, _) => println!("{table}\n{prints}"),
        (true, true) => publish("accuracy.md", PRINTS, &prints)?,
        (true, false) => {
            publish("accuracy.md", MARKS, &table)?;
            publish("accuracy.md", PRINTS, &prints)?;
        }
    }
    Ok(())
}

/// Mean difference of what is shown of two pictures of one size, the second less the first, and its
/// mean size.
fn same_size(one: &Frame, other: &Frame, shown: impl Fn([f64; 3]) -> [f64; 3]) -> [f64; 2] {
    let pairs = one.radiance.iter().zip(&other.radiance);
    let (mut bias, mut size) = (0.0, 0.0);
    for (a, b) in pairs {
        let [a, b] = [a, b].map(|light| shown(light.map(f64::from)));
        for c in 0..3 {
            bias += b[c] - a[c];
            size += (b[c] - a[c]).abs();
        }
    }
    let count = 3.0 * one.radiance.len() as f64;
    [bias / count, size / count]
}
