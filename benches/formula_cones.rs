//! Where cones over the pixels of a formula pay: `cargo bench --bench formula_cones`. With `-- --write` it
//! writes its tables into docs/benchmarks.md. `-- [KEY=VALUE...] [PRESET...]` changes the presets, or chooses some.
//!
//! Each preset is traced by rays alone and with cones from 1/16 on, in turns. The tables have the number that
//! the program estimates from a few rays to choose, here from all pixels, least first.

use anyhow::{Result, ensure};
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::plan::cones::Rule;
use conemarch::plan::look::Look;
use conemarch::plan::{Extras, Pass, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use median::median;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/median.rs"]
mod median;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = ["<!-- formula-cones -->", "<!-- /formula-cones -->"];
const SMALL: [u32; 2] = [640, 360];
const LARGE: [u32; 2] = [1280, 720];
/// Runs before those that a median is taken of: the first counts, and the second compiles.
const BEFORE: usize = 2;
/// The coarsest level of rays alone, and of cones.
const COARSEST: [u32; 2] = [1, 16];

/// The number that the program estimates to choose, and a row with it.
type Row = (f64, String);

/// Compares rays alone with cones, `runs` times.
fn row(executors: &mut [Executor], name: &str, plan: &Plan, runs: usize) -> Result<Row> {
    let assets = Assets::default();
    let chosen = plan.resolved(Extras::default(), &assets).levels().len();
    let mut times = [vec![], vec![]];
    // Evaluations of the rays of each, and of the cones.
    let (mut rays, mut cones) = ([0.0; 2], 0.0);
    for run in 0..BEFORE + runs {
        for (nth, coarsest) in COARSEST.into_iter().enumerate() {
            let mut plan = plan.clone();
            plan.march.coarsest = Some(coarsest);
            let extras = Extras {
                // Without colours a pixel has one sample.
                depth_only: plan.samples == 1,
                count: run == 0,
                unread: run > 0,
                ..Extras::default()
            };
            let frame = executors[nth].render(&plan, &assets, extras, &mut |_| true)?;
            if run >= BEFORE {
                times[nth].push(frame.march_ms);
            }
            for pass in &frame.passes {
                let evaluations = pass.evaluations.unwrap_or(0) as f64;
                match pass.pass {
                    Pass::Trace => rays[nth] += evaluations,
                    Pass::March(_) => cones += evaluations,
                    _ => {}
                }
            }
        }
    }
    let [alone, with] = times.map(median);
    let (rule, [w, h]) = (Rule::of(plan), plan.size);
    let passes = rule.passes * f64::from(w * h);
    let [cones, passes, left] = [cones, passes, rays[1]].map(|n| n / rays[0]);
    let number = rule.price * cones + passes + left;
    // Through a lens, the centre of a pixel has one more ray.
    let per_ray = rays[0] / f64::from(w * h * plan.visits());
    let chosen = if chosen > 0 { "cones" } else { "none" };
    let row = format!(
        "{name} | {w} x {h} | {per_ray:.1} | {cones:.2} | {left:.2} | {number:.2} | {alone:.0} | {with:.0} | {:.2} | {chosen}",
        with / alone
    );
    Ok((number, row))
}

fn table(samples: &str, mut rows: Vec<Row>) -> String {
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let head = format!(
        "march and trace, {samples} | size | evaluations of a ray alone | share of cones | share of rays after them | number | rays alone, ms | with cones, ms | with / alone | chosen"
    );
    markdown::table(&head, "llrrrrrrrl", rows.into_iter().map(|row| row.1))
}

fn main() -> Result<()> {
    let writes = std::env::args().any(|a| a == "--write");
    let changes = std::env::args().filter(|a| a.contains('='));
    let changes: Result<Vec<_>, _> = changes.map(|c| Override::read(&c)).collect();
    let mut changes = changes?;
    let args = std::env::args().skip(1);
    let names: Vec<_> = args
        .filter(|a| !a.contains('=') && !a.starts_with("--"))
        .collect();
    let is_usual = changes.is_empty() && names.is_empty();
    ensure!(is_usual || !writes, "--write needs all presets as they are");
    changes.push(Override::read("march.coarsest=auto")?);
    let mut executors = Vec::new();
    for _ in COARSEST {
        executors.push(Executor::open(&Choice::Auto)?.0);
    }
    let [mut one, mut many] = [vec![], vec![]];
    for (name, _) in preset::BUILTIN {
        let mut plan = preset::load(name, &changes)?.plan.one_sample();
        let is_asked = names.is_empty() || names.iter().any(|n| n == name);
        if !plan.scene.tells_distance() || !is_asked {
            continue;
        }
        eprintln!("{name}");
        for size in [LARGE, SMALL] {
            plan.size = size;
            one.push(row(&mut executors, name, &plan, 5)?);
        }
        // Colours that take no time.
        plan.look = Look {
            key: 0.0,
            occlusion: 0.0,
            ..Look::default()
        };
        plan.samples = 16;
        many.push(row(&mut executors, name, &plan, 3)?);
    }
    let [one, many] = [("one sample", one), ("16 samples", many)].map(|(s, rows)| table(s, rows));
    publish::publish("benchmarks.md", MARKS, &format!("{one}\n{many}"))
}
