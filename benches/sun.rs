//! What a cone about the sun proves: `cargo bench --bench sun -- --write`.
//!
//! At each hit that faces the sun, 16 rays go to points of the sun's disc. A cone about the disc
//! starts at the hit, and another one is so wide that it holds the hits of all samples of the pixel.
//! Where that one ends, the rays may begin there.
//! `--write` puts the table into docs/benchmarks.md.

use std::f64::consts::TAU;

use anyhow::Result;
use conemarch::base::outcome::Counts;
use conemarch::base::view::{Beam, footprint};
use conemarch::cpu;
use conemarch::pass::look::Light;
use conemarch::plan::{Extras, Plan};
use conemarch::preset;
use conemarch::scene::{Advance, Assets, Solid, Task};
use follow::{STEPS, follow};
use glam::DVec3;
use publish::publish;

#[path = "common/follow.rs"]
mod follow;
#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/publish.rs"]
mod publish;

/// The marks around the table in the page.
const MARKS: [&str; 2] = ["<!-- sun -->", "<!-- /sun -->"];
const PRESETS: [&str; 6] = [
    "mandelbox",
    "mandelbox-canyon",
    "mandelbox-gate",
    "mandelbox-julia",
    "stones",
    "terrain",
];
/// Rays to points of the disc.
const RAYS: usize = 16;
/// Samples that a pixel's cone stands for.
const SAMPLES: f64 = 16.0;
/// The radius of the samples' filter in footprints, which are half a pixel.
const FILTER: f64 = 3.0;
/// A cone stops after a step that gains less than this share of its front.
const LEAST: f64 = 1e-3;

/// What the hits of a picture that face the sun add up to.
#[derive(Default)]
struct Census {
    facing: f64,
    /// Hits from which all rays, and only some, reach the sun.
    lit: f64,
    penumbra: f64,
    ray_evaluations: f64,
    /// Those that are left where rays begin at the end of the pixel's cone.
    late_evaluations: f64,
    /// Those of hits and of pixels.
    cones: [Cones; 2],
}

/// What cones about the sun add up to.
#[derive(Clone, Copy, Default)]
struct Cones {
    /// Cones that reach the sun.
    free: f64,
    evaluations: f64,
    /// Evaluations of the rays where the cone does not reach the sun.
    left: f64,
}

impl Cones {
    /// Evaluations of cones and of the rays that are left, over those of rays alone, where a cone
    /// stands for so many samples.
    fn cost(&self, samples: f64, rays: f64) -> f64 {
        (self.evaluations / samples + self.left) / rays
    }
}

/// Counts the hits of a frame.
struct Count<'a> {
    plan: &'a Plan,
    light: Light,
    depth: &'a [f32],
    normal: &'a [[f32; 3]],
}

impl Task for Count<'_> {
    type Output = Census;

    fn run<S: Solid>(self, solid: &S) -> Census {
        let mut census = Census::default();
        let view = self.plan.view();
        let sun = self.light.sun(solid.bounds_far());
        let width = self.plan.size[0];
        for (i, (depth, normal)) in (0..).zip(self.depth.iter().zip(self.normal)) {
            let (t, normal) = (f64::from(*depth), DVec3::from(normal.map(f64::from)));
            if !t.is_finite() || normal.dot(sun.axis) <= 0.0 {
                continue;
            }
            let ray = view.view_ray([i % width, i / width]);
            let grain = footprint(&ray, t);
            let beam = |axis, r0, k| Beam {
                origin: ray.at(t) + solid.shadow_lift(grain) * normal,
                axis,
                r0,
                k,
                grain0: grain,
                grain: 0.0,
            };
            // The chord of the half angle.
            let k = 2.0 * (0.5 * sun.softness.atan()).sin();
            let ends = [0.0, FILTER * grain].map(|r0| clear(solid, &beam(sun.axis, r0, k)));
            let free = ends.map(|(front, _)| front > solid.bounds_far());
            let side = sun.axis.any_orthonormal_vector();
            let other = sun.axis.cross(side);
            let reaches = (0..RAYS).filter(|nth| {
                // A spiral of equal areas.
                let share = (*nth as f64 + 0.5) / RAYS as f64;
                let (sin, cos) = (TAU * 0.618_034 * *nth as f64).sin_cos();
                let off = sun.softness * share.sqrt();
                let axis = (sun.axis + off * (cos * side + sin * other)).normalize();
                let ray = beam(axis, 0.0, 0.0);
                let (lit, work) = follow(solid, &ray, [0.0, sun.far]);
                let share = f64::from(work.evaluations) / RAYS as f64;
                census.ray_evaluations += share;
                for (cones, free) in census.cones.iter_mut().zip(free) {
                    cones.left += if free { 0.0 } else { share };
                }
                if !free[1] {
                    let (_, work) = follow(solid, &ray, [ends[1].0, sun.far]);
                    census.late_evaluations += f64::from(work.evaluations) / RAYS as f64;
                }
                lit
            });
            let reaches = reaches.count();
            for (cones, (free, (_, evaluations))) in
                census.cones.iter_mut().zip(free.into_iter().zip(ends))
            {
                cones.free += f64::from(u8::from(free));
                cones.evaluations += evaluations;
            }
            census.facing += 1.0;
            census.lit += f64::from(u8::from(reaches == RAYS));
            census.penumbra += f64::from(u8::from(reaches > 0 && reaches < RAYS));
        }
        census
    }
}

/// How far a cone is proven free, and its evaluations.
fn clear<S: Solid>(solid: &S, cone: &Beam) -> (f64, f64) {
    let mut work = Counts::default();
    let mut at = Advance::at(0.0, true);
    for _ in 0..STEPS {
        let front = at.front;
        at = solid.advance(cone, at, &mut work);
        let gained = at.front - front;
        if at.front > solid.bounds_far() || gained <= LEAST * at.front {
            break;
        }
    }
    (at.front, f64::from(work.evaluations))
}

fn main() -> Result<()> {
    let mut rows = Vec::new();
    for name in PRESETS {
        eprintln!("{name}");
        let mut plan = preset::load(name, &[])?.plan.one_sample();
        plan.size = [320, 180];
        let extras = Extras {
            normals: true,
            ..Extras::default()
        };
        let assets = Assets::default();
        let frame = cpu::render(&plan, &assets, extras, &mut |_| true)?;
        let solid = plan.scene.solid(&plan.viewpoint(), &assets)?;
        let light = Light::of(&plan, &solid);
        let census = solid.run(Count {
            plan: &plan,
            light,
            depth: &frame.depth,
            normal: &frame.normal,
        });
        let percent = |n: f64| 100.0 * n / census.facing;
        let ray = census.ray_evaluations / census.facing;
        let rays = census.ray_evaluations;
        let [own, all] = census.cones;
        rows.push(format!(
            "{name} | {:.1} | {:.1} | {ray:.1} | {:.1} | {:.1} | {:.2} | {:.1} | {:.1} | {:.2} | {:.2}",
            percent(census.lit),
            percent(census.penumbra),
            percent(own.free),
            own.evaluations / census.facing,
            own.cost(1.0, rays),
            percent(all.free),
            all.evaluations / census.facing,
            all.cost(SAMPLES, rays),
            (all.evaluations / SAMPLES + census.late_evaluations) / rays,
        ));
    }
    let table = markdown::table(
        "hits that face the sun | lit by all of it, % | by a part, % | evaluations of a ray | a cone proves, % | its evaluations | cost over rays | a cone for 16 samples proves, % | its evaluations | cost over rays | if rays begin at its end",
        "lr",
        rows,
    );
    publish("benchmarks.md", MARKS, &table)
}
