//! What cones could save at most: `cargo bench --bench limits`. With `-- --write` it writes its
//! table into docs/benchmarks.md.
//!
//! *Ideal cones* cost nothing. Each belongs to a cell of 2 x 2 pixels and goes on until a step gains
//! next to nothing: no other order or length of steps brings such a cone farther by the same empty
//! balls. Rays from their fronts are counted on the CPU, in groups of 8 x 4 pixels spread over the
//! picture.
//!
//! Rays to the sun from the hits are counted too: what their groups wait for is what lanes could save
//! that take the next ray.

use anyhow::Result;
use conemarch::base::outcome::Counts;
use conemarch::base::view::{Beam, footprint};
use conemarch::cpu;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::{Advance, Assets, Solid, Step, Task};
use publish::publish;
use views::VIEWS;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;
#[path = "common/views.rs"]
mod views;

const MARKS: [&str; 2] = ["<!-- limits -->", "<!-- /limits -->"];
/// Presets of heights.
const FIELDS: [&str; 4] = ["bricks", "spikes", "stones", "terrain"];
/// More presets whose rays to the sun are counted.
const SUNNY: [&str; 4] = [
    "mandelbox",
    "mandelbox-canyon",
    "mandelbox-hall",
    "mandelbox-towers",
];
/// One group in so many along each axis is counted.
const EVERY: u32 = 5;
/// Pixels of a group.
const GROUP: [u32; 2] = [8, 4];
/// Steps of a ray, and of a cone.
const STEPS: u32 = 512;
/// A cone ends after a step that gains less than this share of its front.
const LEAST: f64 = 1e-4;

/// Which rays are counted.
#[derive(Clone, Copy, PartialEq)]
enum Rays {
    Alone,
    FromIdealCones,
    /// From the hits.
    ToSun,
}

/// Follows the rays of groups of pixels.
struct Follow<'a> {
    plan: &'a Plan,
    rays: Rays,
}

impl Task for Follow<'_> {
    /// Counts of the rays of each group.
    type Output = Vec<Vec<Counts>>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let view = self.plan.view();
        let far = solid.bounds_far();
        let sun = self.plan.look.light.normalize();
        let [columns, rows] = [0, 1].map(|axis| self.plan.size[axis] / (GROUP[axis] * EVERY));
        let groups = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
        let follow = |pixel: [u32; 2]| {
            let mut front = 0.0;
            if self.rays == Rays::FromIdealCones {
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
            if front > far {
                return work;
            }
            let ray = view.view_ray(pixel);
            let (end, walk) = follow_ray(solid, &ray, [front, far], &mut work);
            if self.rays != Rays::ToSun {
                return work;
            }
            let mut work = Counts::default();
            if end == Step::Hit {
                let hit = solid.walk_hit(&walk);
                let normal = solid.surface(&ray, &hit).normal;
                let grain = footprint(&ray, hit.t);
                let ray = Beam {
                    origin: ray.at(hit.t) + solid.shadow_lift(grain) * normal,
                    axis: sun,
                    r0: 0.0,
                    k: 0.0,
                    grain0: grain,
                    grain: 0.0,
                };
                if normal.dot(sun) > 0.0 {
                    follow_ray(solid, &ray, [0.0, 2.0 * far], &mut work);
                }
            }
            work
        };
        groups
            .map(|group| {
                let [x, y] = [0, 1].map(|axis| group[axis] * GROUP[axis] * EVERY);
                // Groups of 4 x 2 within it, one after the other.
                let pixels =
                    (0..32).map(|i| [x + i / 8 % 2 * 4 + i % 4, y + i / 16 * 2 + i % 8 / 4]);
                pixels.map(follow).collect()
            })
            .collect()
    }
}

/// Follows a ray from one distance to another.
fn follow_ray<S: Solid>(
    solid: &S,
    ray: &Beam,
    [from, to]: [f64; 2],
    work: &mut Counts,
) -> (Step, S::Walk) {
    let mut walk = solid.begin(ray, from, to, work);
    let mut step = Step::Moving;
    for _ in 0..STEPS {
        step = solid.walk_step(ray, &mut walk, work);
        if step != Step::Moving {
            break;
        }
    }
    (step, walk)
}

/// Cost per pixel if the pixels of each group of `width` wait for the longest.
fn cost(groups: &[Vec<Counts>], width: usize, of: fn(&Counts) -> u32) -> f64 {
    let most = groups.iter().flat_map(|group| group.chunks(width));
    let most: Vec<f64> = most
        .filter_map(|lanes| lanes.iter().map(of).max().map(f64::from))
        .collect();
    most.iter().sum::<f64>() / most.len() as f64
}

fn counted(name: &str, size: [u32; 2], changes: &[&str], rays: Rays) -> Result<Vec<Vec<Counts>>> {
    let changes: Result<Vec<_>, _> = changes.iter().map(|c| Override::read(c)).collect();
    let mut plan = preset::load(name, &changes?)?.plan.one_sample();
    // A small picture makes the maps.
    let assets = Assets::default();
    plan.size = [16, 9];
    cpu::render(&plan, &assets, Extras::default(), &mut |_| true)?;
    plan.size = size;
    let solid = plan.scene.solid(&plan.viewpoint(), &assets)?;
    Ok(solid.run(Follow { plan: &plan, rays }))
}

fn row(name: &str, rays: &[Vec<Counts>], ideal: &[Vec<Counts>], of: fn(&Counts) -> u32) -> String {
    let part = |width| {
        let [rays, ideal] = [rays, ideal].map(|groups| cost(groups, width, of));
        format!("{rays:.1} | {ideal:.1} | {:.2}", rays / ideal)
    };
    format!("{name} | {} | {}", part(32), part(1))
}

fn main() -> Result<()> {
    let mut rows = Vec::new();
    for name in VIEWS {
        eprintln!("{name}");
        let size = [1920, 1080];
        let rival = ["march.mode=ray-relaxed", "march.clip=on"];
        let rival = counted(name, size, &rival, Rays::Alone)?;
        let ideal = counted(name, size, &[], Rays::FromIdealCones)?;
        rows.push(row(name, &rival, &ideal, |c| c.iterations));
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
        let rival = counted(name, size, &[], Rays::Alone)?;
        let ideal = counted(name, size, &[], Rays::FromIdealCones)?;
        rows.push(row(name, &rival, &ideal, |c| c.evaluations));
    }
    let fields = markdown::table(
        "steps per pixel, 1280 x 720 | rays, in groups | ideal cones, in groups | ratio | rays, alone | ideal cones, alone | ratio",
        "lr",
        rows,
    );
    let mut rows = Vec::new();
    for name in VIEWS.into_iter().chain(SUNNY).chain(FIELDS) {
        eprintln!("{name}, to the sun");
        let groups = counted(name, [1280, 720], &[], Rays::ToSun)?;
        let of = |c: &Counts| c.iterations.max(c.evaluations);
        let [wide, narrow, alone] = [32, 8, 1].map(|width| cost(&groups, width, of));
        rows.push(format!(
            "{name} | {wide:.1} | {narrow:.1} | {alone:.1} | {:.2} | {:.2}",
            wide / alone,
            narrow / alone
        ));
    }
    let sun = markdown::table(
        "rays to the sun per pixel, 1280 x 720 | in groups of 32 | in groups of 8 | alone | 32 / alone | 8 / alone",
        "lr",
        rows,
    );
    publish(
        "benchmarks.md",
        MARKS,
        &format!("{formulas}\n{fields}\n{sun}"),
    )
}
