//! What cones could save at most: `cargo bench --bench limits`. With `-- --write` it writes its
//! table into docs/benchmarks.md.
//!
//! *Ideal cones* cost nothing. Each belongs to a cell of 2 x 2 pixels and goes on until a step gains
//! next to nothing: no other order or length of steps brings such a cone farther by the same empty
//! balls. Rays from their fronts are counted on the CPU, in groups of 8 x 4 pixels spread over the
//! picture.
//!
//! Rays from the eye, cones, rays to the sun and searches for occlusion are counted with lanes that take
//! the next one of their tile, too, as if taking it cost nothing.

use anyhow::Result;
use conemarch::base::outcome::Counts;
use conemarch::base::view::{Beam, footprint};
use conemarch::cpu;
use conemarch::pass::look::Light;
use conemarch::pass::occlusion::nearest;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::{Advance, Assets, ROOMS, Solid, Step, Task};
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
/// More presets for lanes that take the next ray.
const MORE: [&str; 4] = [
    "mandelbox",
    "mandelbox-canyon",
    "mandelbox-hall",
    "mandelbox-towers",
];
/// One tile in so many along each axis is counted.
const EVERY: u32 = 3;
/// Pixels of a tile along each axis.
const TILE: u32 = 16;
/// Groups of lanes: a wide one has 8 x 4 pixels, a narrow one 4 x 2.
const WIDE: usize = 32;
const NARROW: usize = 8;
/// All cones of a picture. The others are rays of every third tile.
const CONES: &str = "cones of all levels";
/// There are [`ROOMS`] for each pixel.
const SEARCHES: &str = "searches for occlusion";
/// Steps of a ray, and of a cone.
const STEPS: u32 = 512;
/// A cone ends after a step that gains less than this share of its front.
const LEAST: f64 = 1e-4;

/// What is counted.
#[derive(Clone, Copy, PartialEq)]
enum Rays {
    Alone,
    FromIdealCones,
    /// From the hits.
    ToSun,
    /// No rays, but searches for the free room about points above the hits, for occlusion: those of one
    /// of the distances from the hits.
    Room(u32),
}

/// Follows the rays of tiles.
struct Follow<'a> {
    plan: &'a Plan,
    light: Light,
    rays: Rays,
}

impl Task for Follow<'_> {
    /// Counts of the rays of each tile, group by group.
    type Output = Vec<Vec<Counts>>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let view = self.plan.view();
        let far = solid.bounds_far();
        let sun = self.plan.look.light.normalize();
        let [columns, rows] = self.plan.size.map(|side| side / (TILE * EVERY));
        let tiles = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
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
            if matches!(self.rays, Rays::Alone | Rays::FromIdealCones) {
                return work;
            }
            let mut work = Counts::default();
            if end == Step::Hit {
                let hit = solid.walk_hit(&walk);
                let normal = solid.surface(&ray, &hit).normal;
                let grain = footprint(&ray, hit.t);
                if let Rays::Room(nth) = self.rays {
                    let h = nearest(&self.light, grain) * f64::from(1 << nth);
                    solid.room(ray.at(hit.t) + h * normal, h, &mut work);
                    return work;
                }
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
        tiles
            .map(|tile| {
                let corner = tile.map(|n| n * TILE * EVERY);
                (0..TILE * TILE).map(|i| follow(place(corner, i))).collect()
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

/// Cost per ray or cone if those of each group of `width` wait for the longest.
fn cost(tiles: &[Vec<Counts>], width: usize, of: fn(&Counts) -> u32) -> f64 {
    let groups = tiles.iter().flat_map(|tile| tile.chunks(width));
    let most: f64 = groups
        .filter_map(|lanes| lanes.iter().map(of).max().map(f64::from))
        .sum();
    most * width as f64 / tiles.iter().map(Vec::len).sum::<usize>() as f64
}

/// Cost per ray or cone if a tile has one group of `width` lanes, of which each takes the next one of
/// the tile as soon as it is free.
fn cost_of_takers(tiles: &[Vec<Counts>], width: usize, of: fn(&Counts) -> u32) -> f64 {
    let work = |tile: &Vec<Counts>| {
        let mut busy = vec![0; width];
        for ray in tile.iter().map(of) {
            if let Some(first) = busy.iter_mut().min() {
                *first += ray;
            }
        }
        busy.into_iter().max().unwrap_or(0)
    };
    let all: f64 = tiles.iter().map(|tile| f64::from(work(tile))).sum();
    all * width as f64 / tiles.iter().map(Vec::len).sum::<usize>() as f64
}

/// The visited cells of all levels, in tiles of their level.
fn cones(name: &str, size: [u32; 2]) -> Result<Vec<Vec<Counts>>> {
    let mut plan = preset::load(name, &[])?.plan.one_sample();
    plan.size = size;
    let extras = Extras {
        count: true,
        levels: true,
        depth_only: true,
        ..Extras::default()
    };
    let frame = cpu::render(&plan, &Assets::default(), extras, &mut |_| true)?;
    let mut tiles = Vec::new();
    for level in &frame.levels {
        let [columns, rows] = level.cells.map(|side| side.div_ceil(TILE));
        for tile in (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y])) {
            let corner = tile.map(|n| n * TILE);
            let cells = (0..TILE * TILE).map(|i| place(corner, i));
            let cells = cells.filter(|[x, y]| *x < level.cells[0] && *y < level.cells[1]);
            let work = cells.map(|[x, y]| level.work[(x + level.cells[0] * y) as usize]);
            tiles.push(work.filter(|work| work.evaluations > 0).collect());
        }
    }
    Ok(tiles)
}

/// A place in a tile. Narrow groups lie within wide ones, these in rows of two.
fn place(corner: [u32; 2], i: u32) -> [u32; 2] {
    let (group, narrow, lane) = (i / 32, i / 8 % 4, i % 8);
    [
        corner[0] + group % 2 * 8 + narrow % 2 * 4 + lane % 4,
        corner[1] + group / 2 * 4 + narrow / 2 * 2 + lane / 4,
    ]
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
    let light = Light::of(&plan, &solid);
    let plan = &plan;
    Ok(solid.run(Follow { plan, light, rays }))
}

fn ideal_row(
    name: &str,
    rays: &[Vec<Counts>],
    ideal: &[Vec<Counts>],
    of: fn(&Counts) -> u32,
) -> String {
    let part = |width| {
        let [rays, ideal] = [rays, ideal].map(|groups| cost(groups, width, of));
        format!("{rays:.1} | {ideal:.1} | {:.2}", rays / ideal)
    };
    format!("{name} | {} | {}", part(WIDE), part(1))
}

/// What lanes wait for, and what is left of it if they take the next ray or cone.
fn lanes(title: &str, of: impl Fn(&str, [u32; 2]) -> Result<Vec<Vec<Counts>>>) -> Result<String> {
    let size = [1280, 720];
    let mut rows = Vec::new();
    for name in VIEWS.into_iter().chain(MORE).chain(FIELDS) {
        eprintln!("{name}, {title}");
        let tiles = of(name, size)?;
        if tiles.is_empty() {
            continue;
        }
        let of = |c: &Counts| c.iterations.max(c.evaluations);
        let all: f64 = tiles.iter().flatten().map(|c| f64::from(of(c))).sum();
        let pixels = match title {
            CONES => f64::from(size[0] * size[1]),
            SEARCHES => (tiles.iter().flatten().count() / ROOMS) as f64,
            _ => tiles.iter().flatten().count() as f64,
        };
        let part = |width| {
            let [wait, take] = [cost(&tiles, width, of), cost_of_takers(&tiles, width, of)];
            let alone = cost(&tiles, 1, of);
            format!("{:.2} | {:.2}", wait / alone, take / alone)
        };
        rows.push(format!(
            "{name} | {:.1} | {} | {}",
            all / pixels,
            part(WIDE),
            part(NARROW)
        ));
    }
    Ok(markdown::table(
        &format!(
            "{title}, 1280 x 720 | alone, per pixel | 32 lanes that wait | 32 that take | 8 lanes that wait | 8 that take"
        ),
        "lr",
        rows,
    ))
}

fn main() -> Result<()> {
    let mut rows = Vec::new();
    for name in VIEWS {
        eprintln!("{name}");
        let size = [1920, 1080];
        let rival = ["march.mode=ray-relaxed", "march.clip=on"];
        let rival = counted(name, size, &rival, Rays::Alone)?;
        let ideal = counted(name, size, &[], Rays::FromIdealCones)?;
        rows.push(ideal_row(name, &rival, &ideal, |c| c.iterations));
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
        rows.push(ideal_row(name, &rival, &ideal, |c| c.evaluations));
    }
    let fields = markdown::table(
        "steps per pixel, 1280 x 720 | rays, in groups | ideal cones, in groups | ratio | rays, alone | ideal cones, alone | ratio",
        "lr",
        rows,
    );
    let eye = lanes("rays from the eye", |name, size| {
        counted(name, size, &[], Rays::Alone)
    })?;
    let cones = lanes(CONES, cones)?;
    let sun = lanes("rays to the sun", |name, size| {
        counted(name, size, &[], Rays::ToSun)
    })?;
    let rooms = lanes(SEARCHES, |name, size| {
        let tiles: Result<Vec<_>> = (0..ROOMS as u32)
            .map(|nth| counted(name, size, &[], Rays::Room(nth)))
            .collect();
        Ok(tiles?.concat())
    })?;
    publish(
        "benchmarks.md",
        MARKS,
        &format!("{formulas}\n{fields}\n{eye}\n{cones}\n{sun}\n{rooms}"),
    )
}
