//! What rays of light cost: `cargo bench --bench light -- --write`.
//!
//! Renders Mandelboxes with light by paths, in turns: as they are; with each ray making its first step
//! by itself; both without rays to the sun; with light of the sky alone that nothing stops. `--write` puts
//! the table into docs/benchmarks.md.

use std::sync::Arc;

use alone::alone;
use anyhow::{Context, Result};
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::plan::look::LightMode;
use conemarch::plan::{Extras, Pass, Plan};
use conemarch::preset;
use conemarch::scene::Assets;
use publish::publish;

#[path = "common/alone.rs"]
mod alone;
#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

/// The marks around the table in the page.
const MARKS: [&str; 2] = ["<!-- light -->", "<!-- /light -->"];
const PRESETS: [&str; 5] = [
    "mandelbox",
    "mandelbox-canyon",
    "mandelbox-gate",
    "mandelbox-julia",
    "terrain",
];
/// Warm runs, of which the median is taken.
const RUNS: usize = 3;

fn main() -> Result<()> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let mut rows = Vec::new();
    for name in PRESETS {
        let mut plan = preset::load(name, &[])?.plan;
        plan.size = [640, 360];
        plan.samples = 4;
        (plan.look.mode, plan.look.bounces) = (LightMode::Path, 2);
        let mut sunless = plan.clone();
        sunless.look.key = 0.0;
        let mut open = sunless.clone();
        open.look.bounces = 0;
        open.look.occlusion_reach = 1e-4;
        let plans: [&Plan; 5] = [&plan, &plan, &sunless, &sunless, &open];
        let mut renderers = Vec::new();
        for nth in 0..plans.len() {
            let mut renderer = Renderer::new(Device::open(adapter)?);
            renderer.sources = (nth % 2 == 1).then(|| Arc::new(alone) as _);
            renderers.push(renderer);
        }
        let extras = Extras {
            time: true,
            unread: true,
            ..Extras::default()
        };
        let mut times = vec![Vec::new(); plans.len()];
        let mut rays = Vec::new();
        for run in 0..=RUNS {
            for ((renderer, plan), times) in renderers.iter_mut().zip(plans).zip(&mut times) {
                let frame = renderer.render(plan, &Assets::default(), extras, &mut |_| true)?;
                // The first run compiles.
                if run == 0 {
                    continue;
                }
                let of = |color: bool| {
                    let passes = frame.passes.iter();
                    let some = passes.filter(|p| (p.pass == Pass::Color) == color);
                    some.filter_map(|p| p.gpu_ms).sum::<f64>()
                };
                times.push(of(true));
                rays.push(of(false));
            }
        }
        let median = |times: &mut Vec<f64>| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        };
        let [all, alone, sunless, sunless_alone, open] =
            [0, 1, 2, 3, 4].map(|nth| median(&mut times[nth]));
        let rays = median(&mut rays);
        rows.push(format!(
            "{name} | {rays:.0} | {all:.0} | {alone:.0} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2}",
            all / alone,
            (all - sunless) / (alone - sunless_alone),
            sunless / sunless_alone,
            (all - sunless) / (rays + all),
            (sunless - open) / (rays + all),
        ));
    }
    let table = markdown::table(
        "640 x 360, 4 samples, 2 bounces | march and trace, ms | colour, ms | each ray alone, ms | colour / alone | of rays to the sun | of the others | share of rays to the sun | of all other rays of light",
        "lr",
        rows,
    );
    publish("benchmarks.md", MARKS, &table)
}
