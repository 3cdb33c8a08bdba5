//! Light by paths at equal error, of `safe` and of rays alone:
//! `cargo bench --bench equal_error`. With `-- --write` it writes its table into
//! docs/benchmarks.md. It takes half an hour on two cores.
//!
//! The *rival* is mode `ray-relaxed` with `clip` on, as in `rival.rs`, and each of its rays of light makes
//! its first step by itself. Errors are those of a small
//! picture against one of `safe` with many samples, which begin with those of the tested pictures.
//! Times are medians of warm runs in turns. The error falls with the number of samples, so a time is
//! multiplied by the error that remains.

use std::sync::Arc;

use alone::alone;
use anyhow::{Context, Result};
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::picture::frame::Frame;
use conemarch::plan::look::LightMode;
use conemarch::plan::{Extras, Pass, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use publish::publish;

#[path = "common/alone.rs"]
mod alone;
#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = ["<!-- equal-error -->", "<!-- /equal-error -->"];
/// Views of different kinds, and some in which cones save much of march and trace.
const SETS: [[&str; 5]; 2] = [
    [
        "mandelbox",
        "mandelbox-canyon",
        "mandelbox-gate",
        "mandelbox-lattice",
        "mandelbox-reef",
    ],
    [
        "mandelbox-citadel",
        "mandelbox-grotto",
        "mandelbox-hall",
        "mandelbox-temple",
        "mandelbox-towers",
    ],
];
/// The settings of `safe`, and of the rival.
const MODES: [&[&str]; 2] = [&[], &["march.mode=ray-relaxed", "march.clip=on"]];
/// The size and the samples of the pictures whose errors are measured, and of their reference.
const SMALL: [u32; 2] = [80, 45];
const TESTED: u32 = 64;
const REFERENCE: u32 = 4096;
/// Those of the pictures that are timed.
const TIMED: ([u32; 2], u32) = ([640, 360], 16);
/// Warm runs, of which the median is taken.
const RUNS: usize = 3;

struct Bench {
    /// Those of `safe` and of the rival.
    renderers: [Renderer; 2],
    assets: Assets,
}

impl Bench {
    fn render(
        &mut self,
        (plan, nth): (&Plan, usize),
        size: [u32; 2],
        samples: u32,
        unread: bool,
    ) -> Result<Frame> {
        let mut plan = plan.clone();
        (plan.size, plan.samples) = (size, samples);
        let extras = Extras {
            time: true,
            unread,
            ..Extras::default()
        };
        let watch = &mut |_: &_| true;
        Ok(self.renderers[nth].render(&plan, &self.assets, extras, watch)?)
    }

    /// The mean squared errors of both plans.
    fn errors(&mut self, plans: &[Plan; 2]) -> Result<[f64; 2]> {
        let truth = self.render((&plans[0], 0), SMALL, REFERENCE, false)?;
        let mut errors = [0.0; 2];
        for (nth, error) in errors.iter_mut().enumerate() {
            let frame = self.render((&plans[nth], nth), SMALL, TESTED, false)?;
            let channels = frame.radiance.iter().zip(&truth.radiance);
            let squares = channels.flat_map(|(a, b)| [0, 1, 2].map(|i| f64::from(a[i] - b[i])));
            *error = squares.map(|off| off * off).sum::<f64>() / frame.radiance.len() as f64;
        }
        Ok(errors)
    }

    /// Milliseconds of march and trace, and of all passes, of both plans.
    fn times(&mut self, plans: &[Plan; 2]) -> Result<[[f64; 2]; 2]> {
        let mut times = [[Vec::new(), Vec::new()], [Vec::new(), Vec::new()]];
        for run in 0..=RUNS {
            for (nth, times) in times.iter_mut().enumerate() {
                let frame = self.render((&plans[nth], nth), TIMED.0, TIMED.1, true)?;
                // The first run compiles.
                if run > 0 {
                    let of = |some: fn(&Pass) -> bool| {
                        let passes = frame.passes.iter().filter(|p| some(&p.pass));
                        passes.filter_map(|p| p.gpu_ms).sum::<f64>()
                    };
                    times[0].push(of(Pass::marches));
                    times[1].push(of(|_| true));
                }
            }
        }
        Ok(times.map(|of| {
            of.map(|mut times| {
                times.sort_by(f64::total_cmp);
                times[RUNS / 2]
            })
        }))
    }
}

fn main() -> Result<()> {
    let adapters = Adapters::find();
    let (adapter, _) = adapters
        .choose(&Choice::Auto)?
        .context("there is no adapter")?;
    let open = || Ok::<_, anyhow::Error>(Renderer::new(Device::open(adapter)?));
    let mut renderers = [open()?, open()?];
    renderers[1].sources = Some(Arc::new(alone));
    let mut bench = Bench {
        renderers,
        assets: Assets::default(),
    };
    let mut measured = Vec::new();
    for name in SETS.concat() {
        let load = |settings: &[&str]| -> Result<Plan> {
            let settings: Result<Vec<_>, _> = settings.iter().map(|s| Override::read(s)).collect();
            let mut plan = preset::load(name, &settings?)?.plan;
            (plan.look.mode, plan.look.bounces, plan.until) = (LightMode::Path, 2, 0.0);
            Ok(plan)
        };
        let plans = [load(MODES[0])?, load(MODES[1])?];
        let times = bench.times(&plans)?;
        println!("{name}: {times:.0?} ms");
        measured.push((name, plans, times));
    }
    // The references take much longer than what is timed.
    let (mut rows, mut products) = (Vec::new(), [1.0, 1.0]);
    for (nth, (name, plans, [safe, rival])) in measured.into_iter().enumerate() {
        let errors = bench.errors(&plans)?;
        let rise = errors[1] / errors[0];
        let ratios = [0, 1].map(|i| rise * rival[i] / safe[i]);
        products = [0, 1].map(|i| products[i] * ratios[i]);
        rows.push(format!(
            "{name} | {rise:.3} | {:.0} | {:.0} | {:.2} | {:.0} | {:.0} | {:.2}",
            rival[0], safe[0], ratios[0], rival[1], safe[1], ratios[1]
        ));
        let set = SETS[0].len();
        if (nth + 1) % set == 0 {
            let [primary, all] = products.map(|p| p.powf(1.0 / set as f64));
            rows.push(format!(
                "*geometric mean of these five* | | | | {primary:.2} | | | {all:.2}"
            ));
            products = [1.0, 1.0];
        }
    }
    let table = markdown::table(
        "640 x 360, 16 samples, 2 bounces | squared error, rival / safe | march and trace, ms: rival | safe | rival / safe at equal error | all passes, ms: rival | safe | rival / safe at equal error",
        "lr",
        rows,
    );
    publish("benchmarks.md", MARKS, &table)
}
