//! What shadow rays would save if they did not start at the surface: `cargo bench --bench shadows`.
//! With `-- --write` it writes its table into docs/benchmarks.md.
//!
//! The space between the eye and what it sees is empty. So a shadow ray that starts in front of the
//! surface is free until it passes behind something in the picture. Depths of pixels prove nothing, as
//! thin parts can lie between their rays. The fronts of cones are proven. Both take a look-up for each
//! pixel or cell on the way, and prove only the ray to the middle of the sun. *Balls* take fewer
//! look-ups: each lies within the cones of four cells of a level, and holds a piece of the rays to all
//! points of the sun.
//!
//! With a *shared cone*, the rays of a block of pixels go apart for a while, then a cone of parallel
//! rays goes on for all of them, and they go on from its end. It holds the rays to one point of the sun alone.

use anyhow::Result;
use conemarch::base::outcome::Counts;
use conemarch::base::view::{Beam, View, footprint};
use conemarch::cpu;
use conemarch::pass::look::Light;
use conemarch::picture::frame::{Frame, LevelLayer};
use conemarch::plan::{Extras, Plan, WINDOW_STEP};
use conemarch::preset;
use conemarch::scene::{Advance, Assets, Solid, Task};
use follow::{STEPS, follow};
use glam::{DVec2, DVec3};
use publish::publish;

#[path = "common/follow.rs"]
mod follow;
#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = ["<!-- shadows -->", "<!-- /shadows -->"];
/// Views with cones, most of them with much shadow.
const PRESETS: [&str; 6] = [
    "mandelbox-gate",
    "mandelbox-hall",
    "mandelbox-plain",
    "mandelbox-temple",
    "mandelbox-towers",
    "mandelbox-vault",
];
const SIZE: [u32; 2] = [1280, 720];
/// A block has 4 x 4 pixels, in two groups of 8 lanes. One in so many along each axis is counted.
const BLOCK: u32 = 4;
const EVERY: u32 = 4;
const LANES: usize = 8;
/// Balls that are tried for a ray at most. A ball is this share of the way as long, and less where one
/// of that length is not proven.
const BALLS: u32 = 48;
const SHARE: f64 = 0.5;
const SHORTER: f64 = 0.4;
const SHORTEST: f64 = 0.1;
/// How far rays go alone before a shared cone, in its radii. With 2, the shared cone saves less.
const APART: f64 = 6.0;
/// A block whose hits are wider apart than so many of its sides has no cone.
const WIDEST: f64 = 4.0;
/// A cone ends after a step that gains less than this share of its front.
const LEAST: f64 = 1e-2;

/// The cost of a ray before a shared cone, and of the rest.
type Phases = [f64; 2];

/// Ways to shorten shadow rays.
#[derive(Clone, Copy)]
enum Way {
    Alone,
    Depths,
    Fronts,
    /// Those of the pixel's own tile.
    Tile,
    Balls,
    /// Pixels along each side of a block.
    Cone(u32),
}

const WAYS: [Way; 7] = [
    Way::Alone,
    Way::Depths,
    Way::Fronts,
    Way::Tile,
    Way::Balls,
    Way::Cone(2),
    Way::Cone(4),
];

/// Sums over the counted rays.
#[derive(Default)]
struct Sums {
    rays: f64,
    /// Look-ups of fronts, of those in the pixel's own tile, and balls that were tried.
    looks: [f64; 2],
    balls: f64,
    /// For each way.
    costs: [Cost; WAYS.len()],
}

#[derive(Clone, Copy, Default)]
struct Cost {
    alone: f64,
    /// If lanes wait for the longest in each phase. Cones have lanes of their own.
    in_groups: f64,
}

struct Count<'a> {
    plan: &'a Plan,
    light: Light,
    frame: &'a Frame,
}

impl Task for Count<'_> {
    type Output = Sums;

    fn run<S: Solid>(self, solid: &S) -> Sums {
        let view = self.plan.view();
        let sun = self.light.sun(solid.bounds_far());
        let ray_from = |pixel: [u32; 2]| {
            let i = (pixel[0] + SIZE[0] * pixel[1]) as usize;
            let normal = DVec3::from(self.frame.normal[i].map(f64::from));
            let ray = view.view_ray(pixel);
            let t = f64::from(self.frame.depth[i]);
            let grain = footprint(&ray, t);
            (t.is_finite() && normal.dot(sun.axis) > 0.0).then(|| Beam {
                origin: ray.at(t) + solid.shadow_lift(grain) * normal,
                axis: sun.axis,
                r0: 0.0,
                k: 0.0,
                grain0: grain,
                grain: 0.0,
            })
        };
        let by_depth = |[x, y]: [u32; 2]| f64::from(self.frame.depth[(x + SIZE[0] * y) as usize]);
        let levels = &self.frame.levels;
        let by_front = |pixel| {
            levels
                .last()
                .map_or(0.0, |level| front(levels, level, pixel))
        };
        let mut sums = Sums::default();
        let mut cones = [const { Vec::new() }; WAYS.len()];
        let blocks = SIZE.map(|side| side / (BLOCK * EVERY));
        for block in (0..blocks[1]).flat_map(|y| (0..blocks[0]).map(move |x| [x, y])) {
            let corner = block.map(|n| n * BLOCK * EVERY);
            let pixels = (0..BLOCK * BLOCK).map(|i| [i % BLOCK, i / BLOCK]);
            let rays: Vec<Option<Beam>> = pixels
                .map(|[x, y]| ray_from([corner[0] + x, corner[1] + y]))
                .collect();
            sums.rays += rays.iter().flatten().count() as f64;
            for (i, way) in WAYS.into_iter().enumerate() {
                let mut start_of = |ray: &Beam| match way {
                    Way::Depths => free_by(&view, ray, (1, None), by_depth).0,
                    Way::Fronts | Way::Tile => {
                        let tile = matches!(way, Way::Tile).then_some(corner);
                        let (free, looks) = free_by(&view, ray, (2, tile), by_front);
                        sums.looks[usize::from(tile.is_some())] += looks;
                        free
                    }
                    Way::Balls => free_by_balls(&view, ray, sun.softness, levels, &mut sums.balls),
                    Way::Alone | Way::Cone(_) => 0.0,
                };
                let mut phases_of = |ray: &Beam| {
                    let start = start_of(ray);
                    [0.0, iterations(solid, ray, [start, sun.far]).1]
                };
                let phases: Vec<Phases> = match way {
                    Way::Cone(side) => shared(solid, &rays, (side, sun.far), &mut cones[i]),
                    _ => rays
                        .iter()
                        .map(|ray| ray.as_ref().map_or([0.0; 2], &mut phases_of))
                        .collect(),
                };
                let cost = &mut sums.costs[i];
                cost.alone += phases.iter().flatten().sum::<f64>();
                for phase in 0..2 {
                    let all: Vec<f64> = phases.iter().map(|lane| lane[phase]).collect();
                    cost.in_groups += in_groups(&all);
                }
            }
        }
        for (cost, cones) in sums.costs.iter_mut().zip(cones) {
            cost.alone += cones.iter().sum::<f64>();
            cost.in_groups += in_groups(&cones);
        }
        sums
    }
}

/// What lanes cost that wait for the longest of their group.
fn in_groups(all: &[f64]) -> f64 {
    let longest = |lanes: &[f64]| lanes.iter().copied().fold(0.0, f64::max);
    LANES as f64 * all.chunks(LANES).map(longest).sum::<f64>()
}

/// The phases of rays of which blocks share a cone. Adds the costs of the cones.
fn shared<S: Solid>(
    solid: &S,
    rays: &[Option<Beam>],
    (side, far): (u32, f64),
    cones: &mut Vec<f64>,
) -> Vec<Phases> {
    let mut all = vec![[0.0; 2]; rays.len()];
    let parts = BLOCK / side;
    for part in 0..parts * parts {
        let first = [part % parts * side, part / parts * side];
        let places = (0..side * side)
            .map(|n| (first[0] + n % side + BLOCK * (first[1] + n / side)) as usize);
        let group: Vec<(usize, Beam)> =
            places.clone().filter_map(|i| Some((i, rays[i]?))).collect();
        let Some((_, first)) = group.first() else {
            continue;
        };
        let middle = group.iter().map(|(_, ray)| ray.origin).sum::<DVec3>() / group.len() as f64;
        let along = |ray: &Beam| (ray.origin - middle).dot(ray.axis);
        let aside = |ray: &Beam| {
            (ray.origin - middle)
                .reject_from_normalized(ray.axis)
                .length()
        };
        let wide = group.iter().map(|(_, ray)| aside(ray)).fold(0.0, f64::max);
        // A side has two footprints for each pixel.
        if group.len() < 2 || wide > WIDEST * f64::from(2 * side) * first.grain0 {
            for (i, ray) in &group {
                all[*i][0] = iterations(solid, ray, [0.0, far]).1;
            }
            continue;
        }
        let start = APART * wide + group.iter().map(|(_, ray)| along(ray)).fold(0.0, f64::max);
        let mut left = Vec::new();
        for (i, ray) in &group {
            let (free, cost) = iterations(solid, ray, [0.0, start - along(ray)]);
            all[*i][0] = cost;
            left.extend(free.then_some((*i, ray)));
        }
        if left.is_empty() {
            continue;
        }
        let cone = Beam {
            origin: middle,
            r0: wide,
            ..*first
        };
        let mut work = Counts::default();
        let mut at = Advance::at(start, true);
        for _ in 0..STEPS {
            let front = at.front;
            at = solid.advance(&cone, at, &mut work);
            if at.front > far || at.front - front <= LEAST * at.front {
                break;
            }
        }
        cones.push(f64::from(work.iterations));
        for (i, ray) in left {
            all[i][1] = iterations(solid, ray, [at.front - along(ray), far]).1;
        }
    }
    all
}

/// The proven front of a pixel's cell. Children of sky are not visited, and have none of their own.
fn front(levels: &[LevelLayer], level: &LevelLayer, pixel: [u32; 2]) -> f64 {
    let fronts = levels.iter().rev().filter(|l| l.divisor >= level.divisor);
    let mut fronts = fronts.map(|level| {
        let [x, y] = pixel.map(|n| (n / level.divisor) as usize);
        f64::from(level.front[x + level.cells[0] as usize * y])
    });
    fronts.find(|front| *front > 0.0).unwrap_or(0.0)
}

/// Where a point is in the picture, in pixels.
fn place(view: &View, q: DVec3) -> DVec2 {
    let at = DVec2::new(q.dot(view.right), -q.dot(view.up)) / q.dot(view.forward);
    at / view.pixel + 0.5 * DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]))
}

/// The pixel at a place; `None` outside the picture.
fn pixel(place: DVec2) -> Option<[u32; 2]> {
    let inside =
        place.min_element() >= 0.0 && place.x < f64::from(SIZE[0]) && place.y < f64::from(SIZE[1]);
    inside.then(|| place.to_array().map(|n| n as u32))
}

/// How far a ray is nearer to the eye than the distances of the picture, which has a distance for each
/// cell of some pixels, and may be a tile alone: that of a pixel. Also returns the look-ups.
fn free_by(
    view: &View,
    ray: &Beam,
    (cell, tile): (u32, Option<[u32; 2]>),
    distance: impl Fn([u32; 2]) -> f64,
) -> (f64, f64) {
    let (mut s, mut looks) = (0.0, 0.0);
    let mut last = None;
    loop {
        let q = ray.at(s);
        let ahead = (q.dot(view.forward) > 0.0).then(|| place(view, q));
        let tile_of = |pixel: [u32; 2]| pixel.map(|n| n / WINDOW_STEP);
        let inside = |pixel: &[u32; 2]| tile.is_none_or(|own| tile_of(own) == tile_of(*pixel));
        let Some(pixel) = ahead.and_then(pixel).filter(inside) else {
            return (s, looks);
        };
        let here = pixel.map(|n| n / cell);
        let known = last.filter(|(at, _)| *at == here);
        let known = known.map_or_else(|| distance(pixel), |(_, known)| known);
        looks += f64::from(u8::from(last.is_none_or(|(at, _)| at != here)));
        last = Some((here, known));
        if q.length() >= known {
            return (s, looks);
        }
        s += view.grain * q.length();
    }
}

/// How far balls about the rays to all points of a light lie within the cones of a picture. Adds to the balls.
fn free_by_balls(
    view: &View,
    ray: &Beam,
    softness: f64,
    levels: &[LevelLayer],
    balls: &mut f64,
) -> f64 {
    let (mut s, mut share) = (0.0, SHARE);
    for _ in 0..BALLS {
        let length = (share * s).max(ray.grain0);
        let q = ray.at(s + 0.5 * length);
        let radius = (0.5 * length).hypot(softness * (s + length));
        let (t, ahead) = (q.length(), q.dot(view.forward));
        if ahead <= radius {
            return s;
        }
        *balls += 1.0;
        // At least as wide as the ball's picture.
        let wide = radius * t / ahead / (ahead - radius) / view.pixel;
        let level = levels
            .iter()
            .rev()
            .find(|l| f64::from(l.divisor) >= 2.0 * wide);
        let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
        let proven = |level| {
            corners.iter().all(|corner| {
                let corner = pixel(place(view, q) + wide * DVec2::from(*corner));
                corner.is_some_and(|pixel| front(levels, level, pixel) >= t + radius)
            })
        };
        if level.is_some_and(proven) {
            (s, share) = (s + length, SHARE);
        } else if share < SHORTEST || length <= ray.grain0 {
            return s;
        } else {
            share *= SHORTER;
        }
    }
    s
}

/// Whether a ray is free from the first distance to the second, and its iterations.
fn iterations<S: Solid>(solid: &S, ray: &Beam, [from, far]: [f64; 2]) -> (bool, f64) {
    if from >= far {
        return (true, 0.0);
    }
    let (free, work) = follow(solid, ray, [from, far]);
    (free, f64::from(work.iterations))
}

fn main() -> Result<()> {
    let mut rows = Vec::new();
    for name in PRESETS {
        eprintln!("{name}");
        let mut plan = preset::load(name, &[])?.plan.one_sample();
        plan.size = SIZE;
        let extras = Extras {
            normals: true,
            levels: true,
            ..Extras::default()
        };
        let assets = Assets::default();
        let frame = cpu::render(&plan, &assets, extras, &mut |_| true)?;
        let solid = plan.scene.solid(&plan.viewpoint(), &assets)?;
        let light = Light::of(&plan, &solid);
        let Sums {
            rays,
            looks,
            balls,
            costs,
        } = solid.run(Count {
            plan: &plan,
            light,
            frame: &frame,
        });
        let [_, depths, fronts, tile, by_balls, two, four] =
            costs.map(|cost| cost.alone / costs[0].alone);
        let [.., tile_in, balls_in, two_in, four_in] =
            costs.map(|cost| cost.in_groups / costs[0].in_groups);
        rows.push(format!(
            "{name} | {:.0} | {depths:.2} | {fronts:.2} | {:.0} | {tile:.2} | {tile_in:.2} | {:.0} | {by_balls:.2} | {balls_in:.2} | {:.0} | {two:.2} | {two_in:.2} | {four:.2} | {four_in:.2}",
            costs[0].alone / rays,
            looks[0] / rays,
            looks[1] / rays,
            balls / rays,
        ));
    }
    let table = markdown::table(
        "rays to the sun, 1280 x 720 | iterations of a ray | by depths | by fronts | look-ups | by fronts of a tile | in groups of 8 | look-ups | by balls | in groups of 8 | balls | a cone for 2 x 2 | in groups of 8 | a cone for 4 x 4 | in groups of 8",
        "lr",
        rows,
    );
    publish("benchmarks.md", MARKS, &table)
}
