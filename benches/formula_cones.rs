//! Where cones over the pixels of a formula pay: `cargo bench --bench formula_cones`. With `-- --write` it
//! writes its table into docs/benchmarks.md.
//!
//! Each preset is traced by rays alone and with cones from 1/16 on, in turns, with one sample. The table
//! has the number by which the program chooses, here from all pixels instead of a few, least first.

use anyhow::Result;
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::plan::cones::DISTANCE;
use conemarch::plan::{Extras, Pass};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use median::median;
use publish::publish;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/median.rs"]
mod median;
#[path = "common/publish.rs"]
mod publish;

/// Warm runs that a median is taken of.
const RUNS: usize = 5;
const MARKS: [&str; 2] = ["<!-- formula-cones -->", "<!-- /formula-cones -->"];
const SIZES: [[u32; 2]; 2] = [[640, 360], [1280, 720]];
/// Rays alone, and cones.
const PLANS: [&str; 2] = ["march.coarsest=1", "march.coarsest=16"];

fn main() -> Result<()> {
    let mut executors = Vec::new();
    for _ in PLANS {
        let (executor, who) = Executor::open(&Choice::Auto)?;
        eprintln!("measuring on {who}");
        executors.push(executor);
    }
    let mut rows: Vec<(f64, String)> = Vec::new();
    for (name, _) in preset::BUILTIN {
        let assets = Assets::default();
        for size in SIZES {
            let own = preset::load(name, &[Override::read("march.coarsest=auto")?])?;
            let mut own = own.plan.one_sample();
            if !own.scene.tells_distance() {
                break;
            }
            eprintln!("{name} {size:?}");
            own.size = size;
            let chosen = own.resolved(Extras::default(), &assets).levels().len();
            let mut times = [vec![], vec![]];
            // Of the rays of each plan, and of the cones.
            let (mut rays, mut cones) = ([0.0; 2], 0.0);
            for run in 0..RUNS + 2 {
                for (nth, change) in PLANS.iter().enumerate() {
                    let mut plan = preset::load(name, &[Override::read(change)?])?;
                    plan.plan.size = size;
                    // The first run counts, and the second compiles.
                    let extras = Extras {
                        depth_only: true,
                        count: run == 0,
                        ..Extras::default()
                    };
                    let plan = plan.plan.one_sample();
                    let frame = executors[nth].render(&plan, &assets, extras, &mut |_| true)?;
                    if run > 1 {
                        times[nth].push(frame.march_ms);
                    }
                    for pass in &frame.passes {
                        let evaluations = pass.evaluations.unwrap_or(0) as f64;
                        match pass.pass {
                            Pass::Trace if run == 0 => rays[nth] = evaluations,
                            Pass::March(_) => cones += evaluations,
                            _ => {}
                        }
                    }
                }
            }
            let [alone, with] = times.map(median);
            let [cones, left] = [cones, rays[1]].map(|n| n / rays[0]);
            let number = DISTANCE.price * cones + left;
            rows.push((
                number,
                format!(
                    "{name} | {} x {} | {:.1} | {cones:.2} | {left:.2} | {number:.2} | {alone:.0} | {with:.0} | {:.2} | {}",
                    size[0],
                    size[1],
                    rays[0] / f64::from(size[0] * size[1]),
                    with / alone,
                    if chosen > 0 { "cones" } else { "none" }
                ),
            ));
        }
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let table = markdown::table(
        "march and trace | size | evaluations of rays alone, per pixel | share of cones | share of rays after them | number | rays alone, ms | with cones, ms | with / alone | chosen",
        "llrrrrrrrl",
        rows.into_iter().map(|row| row.1).collect::<Vec<_>>(),
    );
    publish("benchmarks.md", MARKS, &table)
}
