//! How the time of march and trace grows: `cargo bench --bench scale`.
//!
//! The *rival*, mode `ray-relaxed` with `clip` on, and `safe` are measured in turns, with more
//! pixels, nearer to the surface, with more iterations, and over larger height maps. Times are
//! medians of warm runs on the clock.

use std::time::{Duration, Instant};

use anyhow::Result;
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;

#[path = "common/markdown.rs"]
#[allow(dead_code, reason = "other programs use the rest")]
mod markdown;

/// Warm turns that a median is taken of, at least, and for how long: short times vary more.
const TURNS: usize = 3;
const LEAST: Duration = Duration::from_secs(3);
/// A render with more pixels than this runs once, after a warm one.
const LARGE: u32 = 3_000_000;
const HEIGHTS: [u32; 7] = [90, 180, 360, 720, 1080, 2160, 4320];
const ZOOMS: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];
const ITERATIONS: [u32; 5] = [5, 10, 20, 40, 80];
const MAPS: [u32; 5] = [256, 512, 1024, 2048, 4096];

/// What one row is measured at, and its times: rival, `safe`.
type Row = (f64, [f64; 2]);

struct Bench {
    executor: Executor,
    assets: Assets,
}

impl Bench {
    fn ms(&mut self, plan: &Plan) -> Result<f64> {
        let extras = Extras {
            depth_only: true,
            ..Extras::default()
        };
        let watch = &mut |_: &_| true;
        Ok(self
            .executor
            .render(plan, &self.assets, extras, watch)?
            .march_ms)
    }

    /// The times of a preset with some settings, as the rival and as `safe`.
    fn row(&mut self, name: &str, settings: &[String]) -> Result<[f64; 2]> {
        let rival = ["march.mode=ray-relaxed".to_string(), "march.clip=on".into()];
        let mut plans = Vec::new();
        for more in [&rival[..], &[]] {
            let all = settings.iter().chain(more).map(|s| Override::read(s));
            let all: Result<Vec<_>, _> = all.collect();
            plans.push(preset::load(name, &all?)?.plan.one_sample());
        }
        let pixels = plans[0].size.iter().product::<u32>();
        let turns = if pixels > LARGE { 1 } else { TURNS };
        let mut times = [vec![], vec![]];
        let begin = Instant::now();
        let mut turn = 0;
        while turn <= turns || begin.elapsed() < LEAST {
            for i in [turn % 2, 1 - turn % 2] {
                let ms = self.ms(&plans[i])?;
                // The first turn compiles.
                if turn > 0 {
                    times[i].push(ms);
                }
            }
            turn += 1;
        }
        Ok(times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        }))
    }
}

/// The exponent e of the power x^e that fits the times best, by least squares of the logarithms.
fn exponent(rows: &[Row], of: usize) -> f64 {
    let n = rows.len() as f64;
    let points = rows.iter().map(|(x, ms)| (x.ln(), ms[of].ln()));
    let (mx, my) = points
        .clone()
        .fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (up, down) = points.fold((0.0, 0.0), |(a, b), (x, y)| {
        (a + (x - mx) * (y - my), b + (x - mx) * (x - mx))
    });
    up / down
}

fn show(what: &str, column: &str, labels: &[String], rows: &[Row]) {
    let line = |(label, (_, [rival, safe])): (&String, &Row)| {
        format!("{label} | {rival:.1} | {safe:.1} | {:.2}", rival / safe)
    };
    let [rival, safe] = [0, 1].map(|of| exponent(rows, of));
    let last = format!("exponent | {rival:.2} | {safe:.2} |");
    let lines = labels.iter().zip(rows).map(line).chain([last]);
    let head = format!("{column} | rival, ms | safe, ms | rival / safe");
    println!("{what}\n\n{}", markdown::table(&head, "lr", lines));
}

fn main() -> Result<()> {
    let (executor, who) = Executor::open(&Choice::Auto)?;
    eprintln!("measuring on {who}");
    let assets = Assets::default();
    let mut bench = Bench { executor, assets };
    for name in ["mandelbox-gate", "bench-far", "terrain"] {
        let (mut labels, mut rows) = (Vec::new(), Vec::new());
        for h in HEIGHTS {
            let w = 16 * h / 9;
            eprintln!("{name}, {w} x {h}");
            let row = bench.row(name, &[format!("image.size=[{w}, {h}]")])?;
            labels.push(format!("{w} x {h}"));
            rows.push((f64::from(w * h), row));
        }
        show(
            &format!("`{name}`, by the number of pixels:"),
            "size",
            &labels,
            &rows,
        );
    }
    let eye = preset::load("mandelbox-gate", &[])?.plan.camera;
    let (mut labels, mut rows) = (Vec::new(), Vec::new());
    for zoom in ZOOMS {
        eprintln!("zoom {zoom}");
        let to = eye.target + (eye.eye - eye.target) / zoom;
        let set = format!("camera.eye=[{}, {}, {}]", to.x, to.y, to.z);
        labels.push(format!("{zoom}"));
        rows.push((zoom, bench.row("mandelbox-gate", &[set])?));
    }
    let what = "`mandelbox-gate` at 1280 x 720, with the eye nearer to its target by a factor:";
    show(what, "factor", &labels, &rows);
    let (mut labels, mut rows) = (Vec::new(), Vec::new());
    for n in ITERATIONS {
        eprintln!("{n} iterations");
        labels.push(n.to_string());
        rows.push((
            f64::from(n),
            bench.row("mandelbox-gate", &[format!("scene.iterations={n}")])?,
        ));
    }
    show(
        "`mandelbox-gate` at 1280 x 720, by the iteration limit:",
        "iterations",
        &labels,
        &rows,
    );
    let (mut labels, mut rows) = (Vec::new(), Vec::new());
    for n in MAPS {
        eprintln!("map of {n}");
        labels.push(format!("{n} x {n}"));
        let set = format!("scene.field=fbm:{n}x{n},seed=5,power=4");
        rows.push((f64::from(n), bench.row("terrain", &[set])?));
    }
    show(
        "`terrain` at 1280 x 720, by the samples along a side of its map:",
        "map",
        &labels,
        &rows,
    );
    Ok(())
}
