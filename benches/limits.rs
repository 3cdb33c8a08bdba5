//! What cones could save at most: `cargo bench --bench limits`. With `-- --write` it writes its
//! table into docs/benchmarks.md.
//!
//! *Ideal cones* cost nothing. Each belongs to a cell of 2 x 2 pixels and goes on until a step gains
//! next to nothing: no other order or length of steps brings such a cone farther by the same empty
//! balls. Rays from their fronts are counted on the CPU, in groups of 8 x 4 pixels spread over the
//! picture.

use anyhow::Result;
use conemarch::base::outcome::Counts;
use conemarch::cpu;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::{Advance, Assets, Solid, Step, Task};
use publish::publish;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = ["<!-- limits -->", "<!-- /limits -->"];
/// Presets of distance estimates, with their size.
const FORMULAS: [&str; 6] = [
    "bench-far",
    "bench-graze",
    "bench-inside",
    "bench-outside",
    "bench-thin",
    "mandelbox-gate",
];
/// Presets of heights.
const FIELDS: [&str; 4] = ["bricks", "spikes", "stones", "terrain"];
/// One group in so many along each axis is counted.
const EVERY: u32 = 5;
/// Pixels of a group.
const GROUP: [u32; 2] = [8, 4];
/// Steps of a ray, and of a cone.
const STEPS: u32 = 512;
/// A cone ends after a step that gains less than this share of its front.
const LEAST: f64 = 1e-4;

/// Follows the rays of groups of pixels, alone or from ideal cones.
struct Follow<'a> {
    plan: &'a Plan,
    has_cones: bool,
}

impl Task for Follow<'_> {
    /// Counts of the rays of each group.
    type Output = Vec<Vec<Counts>>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let view = self.plan.view();
        let far = solid.bounds_far();
        let [columns, rows] = [0, 1].map(|axis| self.plan.size[axis] / (GROUP[axis] * EVERY));
        let groups = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
        let follow = |pixel: [u32; 2]| {
            let mut front = 0.0;
            if self.has_cones {
                let cone = view.view_cone(pixel.map(|n| n / 2), 2);
                let mut at = Advance::at(0.0, true);
                for _ in 0..STEPS {
                    front = at.front;
                    at = solid.advance(&cone, at, &mut Counts::default());
                    if at.front > far || at.front - front <= LEAST * at.front {
                        break;
                    }
                }
                front = at.front;
            }
            let mut work = Counts::default();
            if front <= far {
                let ray = view.view_ray(pixel);
                let mut walk = solid.begin(&ray, front, far, &mut work);
                for _ in 0..STEPS {
                    if solid.walk_step(&ray, &mut walk, &mut work) != Step::Moving {
                        break;
                    }
                }
            }
            work
        };
        groups
            .map(|group| {
                let [x, y] = [0, 1].map(|axis| group[axis] * GROUP[axis] * EVERY);
                let pixels = (0..GROUP[0] * GROUP[1]).map(|i| [x + i % GROUP[0], y + i / GROUP[0]]);
                pixels.map(follow).collect()
            })
            .collect()
    }
}

/// Cost per pixel: in the mean, and if the pixels of a group wait for the longest.
fn cost(groups: &[Vec<Counts>], of: fn(&Counts) -> u32) -> [f64; 2] {
    let pixels = groups.iter().flatten().count() as f64;
    let mean = groups
        .iter()
        .flatten()
        .map(|c| f64::from(of(c)))
        .sum::<f64>()
        / pixels;
    let most = groups.iter().filter_map(|group| group.iter().map(of).max());
    [mean, most.map(f64::from).sum::<f64>() / groups.len() as f64]
}

fn counted(
    name: &str,
    size: [u32; 2],
    changes: &[&str],
    has_cones: bool,
) -> Result<Vec<Vec<Counts>>> {
    let changes: Result<Vec<_>, _> = changes.iter().map(|c| Override::read(c)).collect();
    let mut plan = preset::load(name, &changes?)?.plan.one_sample();
    // A small picture makes the maps.
    let assets = Assets::default();
    plan.size = [16, 9];
    cpu::render(&plan, &assets, Extras::default(), &mut |_| true)?;
    plan.size = size;
    let solid = plan.scene.solid(&plan.viewpoint(), &assets)?;
    Ok(solid.run(Follow {
        plan: &plan,
        has_cones,
    }))
}

fn row(name: &str, alone: [f64; 2], ideal: [f64; 2]) -> String {
    let [a, b] = [0, 1].map(|i| alone[i] / ideal[i]);
    format!(
        "{name} | {:.1} | {:.1} | {b:.2} | {:.1} | {:.1} | {a:.2}",
        alone[1], ideal[1], alone[0], ideal[0]
    )
}

fn main() -> Result<()> {
    let mut rows = Vec::new();
    for name in FORMULAS {
        eprintln!("{name}");
        let size = [1920, 1080];
        let rival = ["march.mode=ray-relaxed", "march.clip=on"];
        let rival = counted(name, size, &rival, false)?;
        let ideal = counted(name, size, &[], true)?;
        let iterations = |groups: &[Vec<Counts>]| cost(groups, |c| c.iterations);
        rows.push(row(name, iterations(&rival), iterations(&ideal)));
    }
    let formulas = markdown::table(
        "iterations per pixel, 1920 x 1080 | rival, in groups | ideal cones, in groups | ratio | rival, alone | ideal cones, alone | ratio",
        "lr",
        rows,
    );
    let mut rows = Vec::new();
    for name in FIELDS {
        eprintln!("{name}");
        let size = [1280, 720];
        let rival = counted(name, size, &[], false)?;
        let ideal = counted(name, size, &[], true)?;
        let steps = |groups: &[Vec<Counts>]| cost(groups, |c| c.evaluations);
        rows.push(row(name, steps(&rival), steps(&ideal)));
    }
    let fields = markdown::table(
        "steps per pixel, 1280 x 720 | rays, in groups | ideal cones, in groups | ratio | rays, alone | ideal cones, alone | ratio",
        "lr",
        rows,
    );
    publish("benchmarks.md", MARKS, &format!("{formulas}\n{fields}"))
}
