//! How exact light by paths is: `cargo bench --bench paths`. With `-- --write` it writes its tables
//! into docs/accuracy.md. It takes ten minutes on two cores.

use std::sync::Arc;

use anyhow::{Context, Result};
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::picture::frame::Frame;
use conemarch::plan::look::LightMode;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{self, BUILTIN, Override};
use conemarch::scene::Assets;
use publish::publish;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = [
    "<!-- cargo bench --bench paths -- --write: begin -->",
    "<!-- cargo bench --bench paths -- --write: end -->",
];
/// White surfaces in white light from all sides.
const WHITE: [&str; 10] = [
    "look.palette=[[1, 1, 1], [1, 1, 1]]",
    "look.sky_low=[1, 1, 1]",
    "look.sky_high=[1, 1, 1]",
    "look.light_color=[0, 0, 0]",
    "look.fill=1",
    "look.ground=1",
    "look.fog=0",
    "look.lamp=0",
    "look.lamp2=0",
    "image.reference=auto",
];
/// More bounces than can be set.
const MORE_BOUNCES: u32 = 64;
/// The scenes of the furnace, with their settings and limits of bounces.
const FURNACE: [(&str, &[&str], &[u32]); 11] = [
    (
        "terrain",
        &["scene.normals=patches", "look.roughness=0.05"],
        &[16],
    ),
    (
        "terrain",
        &["scene.normals=patches", "look.roughness=0.2"],
        &[16],
    ),
    (
        "terrain",
        &["scene.normals=patches", "look.roughness=1"],
        &[16],
    ),
    (
        "terrain",
        &[
            "scene.normals=patches",
            "look.roughness=0.05",
            "look.metal=1",
        ],
        &[16],
    ),
    (
        "terrain",
        &[
            "scene.normals=patches",
            "look.roughness=0.2",
            "look.metal=1",
        ],
        &[16],
    ),
    (
        "terrain",
        &["scene.normals=patches", "look.roughness=1", "look.metal=1"],
        &[16],
    ),
    (
        "terrain",
        &["scene.normals=smooth", "look.roughness=0.05"],
        &[16],
    ),
    (
        "terrain",
        &["scene.normals=smooth", "look.roughness=1"],
        &[16],
    ),
    ("mandelbox", &["look.trap=point"], &[0, 2, 8, 16]),
    (
        "mandelbox",
        &["look.trap=point", "image.reference=2160"],
        &[2, 4, 8, 16],
    ),
    (
        "mandelbox-gate",
        &["look.trap=point", "image.reference=2160"],
        &[2, 4, 8, 16, MORE_BOUNCES],
    ),
];
/// Scenes whose noise is measured, at so many samples.
const NOISE: [&str; 4] = ["mandelbox", "mandelbox-gate", "mandelbox-canyon", "terrain"];
const SAMPLES: [u32; 4] = [4, 16, 64, 256];
/// Pictures of independent samples, whose mean error is taken: rare bright paths make single errors vary.
const PICTURES: u32 = 16;
const MOST_SAMPLES: u32 = 4096;
const SIZE: [u32; 2] = [64, 36];

struct Bench {
    renderer: Renderer,
}

fn plan(name: &str, settings: &[&str]) -> Result<Plan> {
    let settings: Result<Vec<_>, _> = settings.iter().map(|s| Override::read(s)).collect();
    let mut plan = preset::load(name, &settings?)?.plan;
    (plan.size, plan.until, plan.look.bloom) = (SIZE, 0.0, 0.0);
    Ok(plan)
}

/// The mean light of the hits in each channel.
fn light(frame: &Frame) -> [f64; 3] {
    let pixels = frame.radiance.iter().zip(&frame.depth);
    let hits = pixels.filter(|(_, depth)| depth.is_finite());
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for (light, _) in hits {
        sum = [0, 1, 2].map(|i| sum[i] + f64::from(light[i]));
        count += 1.0;
    }
    sum.map(|s| s / count)
}

/// The shaders with four times the bounces that are set.
fn more_bounces(path: &str) -> Option<String> {
    let text = include_str!("../wgsl/pass/path.wgsl");
    assert!(text.contains("look.bounces"));
    (path == "wgsl/pass/path.wgsl").then(|| text.replace("look.bounces", "(4u * look.bounces)"))
}

/// The shaders in which all rays go through the centres of pixels, and samples differ by their light alone.
fn centred(path: &str) -> Option<String> {
    const RAY: &str = "view_through(vec2<f32>(pixel), place)";
    let text = include_str!("../wgsl/base/view.wgsl");
    assert!(text.contains(RAY));
    let centre = RAY.replace("place", "vec2<f32>(0.5)");
    (path == "wgsl/base/view.wgsl").then(|| text.replace(RAY, &centre))
}

/// The same, and samples know nothing of each other, nor of those of another picture.
fn independent(path: &str, picture: u32) -> Option<String> {
    const KEY: &str = "random_hash(seed ^ (purpose * 0x9e3779b9u))";
    let text = include_str!("../wgsl/base/random.wgsl");
    assert!(text.contains(KEY));
    let key = format!("random_hash({KEY} + sample + {}u)", picture * MOST_SAMPLES);
    match path {
        "wgsl/base/random.wgsl" => Some(text.replace(KEY, &key)),
        _ => centred(path),
    }
}

impl Bench {
    fn render(&mut self, plan: &Plan, mode: LightMode, samples: u32) -> Result<Frame> {
        let mut plan = plan.clone();
        (plan.look.mode, plan.samples) = (mode, samples);
        let assets = Assets::default();
        let watch = &mut |_: &_| true;
        Ok(self
            .renderer
            .render(&plan, &assets, Extras::default(), watch)?)
    }

    fn furnace(&mut self) -> Result<String> {
        let mut rows = Vec::new();
        // Walls are grey but where a texture colours them.
        let folder = tempfile::tempdir()?;
        let white = folder.path().join("white.png");
        image::RgbImage::from_pixel(4, 4, [255; 3].into()).save(&white)?;
        let texture = format!("scene.texture={}", white.display());
        for (name, own, bounces) in FURNACE {
            for bounces in bounces {
                let is_more = *bounces == MORE_BOUNCES;
                self.renderer.sources = is_more.then(|| Arc::new(more_bounces) as _);
                let set = if is_more { MORE_BOUNCES / 4 } else { *bounces };
                let limit = format!("look.bounces={set}");
                let mut settings = [&WHITE[..], own, &[&limit]].concat();
                if name == "terrain" {
                    settings.push(&texture);
                }
                let frame = self.render(&plan(name, &settings)?, LightMode::Path, 64)?;
                let own: Vec<_> = own.iter().map(|s| format!("`{s}`")).collect();
                let [light, ..] = light(&frame);
                rows.push(format!(
                    "{name} | {} | {bounces} | {light:.4}",
                    own.join(", ")
                ));
            }
        }
        self.renderer.sources = None;
        let head = "white scene in white light | settings | bounces | mean light of the hits";
        Ok(markdown::table(head, "llr", rows))
    }

    fn noise(&mut self) -> Result<String> {
        let mut rows = Vec::new();
        for name in NOISE {
            eprintln!("noise, {name}");
            let plan = plan(name, &["image.reference=auto", "look.bounces=2"])?;
            for is_independent in [true, false] {
                self.renderer.sources = is_independent.then(|| Arc::new(centred) as _);
                let fine = self.render(&plan, LightMode::Path, MOST_SAMPLES)?;
                let pictures = if is_independent { PICTURES } else { 1 };
                let mut errors = [0.0; SAMPLES.len()];
                for picture in 0..pictures {
                    let changed = move |path: &str| independent(path, picture + 1);
                    self.renderer.sources = is_independent.then(|| Arc::new(changed) as _);
                    for (error, samples) in errors.iter_mut().zip(SAMPLES) {
                        let frame = self.render(&plan, LightMode::Path, samples)?;
                        let all = frame.radiance.iter().zip(&fine.radiance);
                        let squares =
                            all.flat_map(|(a, b)| [0, 1, 2].map(|i| f64::from(a[i] - b[i])));
                        let sum = squares.map(|off| off * off).sum::<f64>();
                        *error += sum / (frame.radiance.len() as f64 * f64::from(pictures));
                    }
                }
                let span = f64::from(SAMPLES[3] / SAMPLES[0]);
                let slope = (errors[3] / errors[0]).log(span);
                let cells: Vec<_> = errors.iter().map(|e| format!("{e:.2e}")).collect();
                let [light, ..] = light(&fine);
                let kind = ["as they are", "independent"][usize::from(is_independent)];
                rows.push(format!(
                    "{name}, {kind} | {light:.3} | {} | {slope:.2}",
                    cells.join(" | ")
                ));
            }
        }
        let head = "mean squared error | mean light, red | 4 samples | 16 | 64 | 256 | slope";
        Ok(markdown::table(head, "lr", rows))
    }

    fn beside_quick(&mut self) -> Result<String> {
        let mut rows = Vec::new();
        for (name, _) in BUILTIN {
            eprintln!("beside quick, {name}");
            let plan = plan(name, &[])?;
            let path = light(&self.render(&plan, LightMode::Path, 64)?);
            let quick = light(&self.render(&plan, LightMode::Quick, 64)?);
            let ratios = [0, 1, 2].map(|i| format!("{:.2}", path[i] / quick[i]));
            rows.push(format!("{name} | {}", ratios.join(" | ")));
        }
        let head = "light by paths / quick light | red | green | blue";
        Ok(markdown::table(head, "lr", rows))
    }
}

fn main() -> Result<()> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let renderer = Renderer::new(Device::open(adapter)?);
    let mut bench = Bench { renderer };
    let tables = [bench.furnace()?, bench.noise()?, bench.beside_quick()?].join("\n");
    publish("accuracy.md", MARKS, &tables)
}
