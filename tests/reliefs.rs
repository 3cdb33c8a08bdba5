//! Heightfields as scenes, on both executors: cones never start behind a surface at any size
//! and angle of view, empty balls are empty, and boxes face the way that they are seen from.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

mod adapter;
#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod overclaims;
    pub mod random;
}

use common::overclaims::{brought_near, overclaims};
use common::random::Random;
use conemarch::base::view::Beam;
use conemarch::base::work::State;
use conemarch::cpu;
use conemarch::heightfield::assets::Ready;
use conemarch::heightfield::conemap::generate::cpu::generate;
use conemarch::heightfield::conemap::generate::generator::{Generator, Options};
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::placement::Placement;
use conemarch::heightfield::settings::{HeightfieldSettings, Wrap};
use conemarch::heightfield::tracer::oracle::Oracle;
use conemarch::heightfield::tracer::{LocalRay, Step, Tracer};
use conemarch::pass;
use conemarch::picture::frame::Frame;
use conemarch::plan::Pass;
use conemarch::plan::camera::Camera;
use conemarch::plan::{Extras, Plan};
use conemarch::scene::AnySolid;
use conemarch::scene::Assets;
use conemarch::scene::{self, Scene, Solid};
use glam::DVec3;
use rayon::prelude::*;

const HIT: u8 = State::Hit as u8;
const NORMALS: Extras = Extras {
    count: false,
    normals: true,
    levels: false,
    depth_only: false,
    time: false,
};

/// Heightfields of every kind: rough and smooth, ended, wrapped and tiled, as they lie and
/// turned, patches and boxes.
fn shapes() -> Vec<(&'static str, HeightfieldSettings)> {
    let of = |field: &str, wrap, tiles, patches, depth, turn: [f64; 3]| {
        let mut shape = HeightfieldSettings::default();
        shape.source.field = field.into();
        shape.source.wrap = wrap;
        shape.tiles = tiles;
        shape.patches = patches;
        shape.depth = depth;
        shape.turn = turn.into();
        shape
    };
    use Patches::{Bilinear, Boxes};
    let flat = [0.0; 3];
    let turned = [25.0, -40.0, 60.0];
    let once = [1, 1];
    vec![
        (
            "terrain",
            of(
                "fbm:65x48,seed=5,power=3",
                Wrap::None,
                once,
                Bilinear,
                2.6,
                flat,
            ),
        ),
        (
            "turned",
            of("ridges:33x40", Wrap::None, once, Bilinear, 3.0, turned),
        ),
        (
            "spikes",
            of("spikes:40x40", Wrap::None, once, Bilinear, 4.0, flat),
        ),
        (
            "boxes",
            of("spikes:24x17", Wrap::None, once, Boxes, 4.0, flat),
        ),
        (
            "wrapped",
            of("fbm:31x24", Wrap::Y, once, Bilinear, 2.0, turned),
        ),
        (
            "tiled",
            of("stones:16x11", Wrap::Both, [2, 3], Bilinear, 1.5, flat),
        ),
        (
            "tiled boxes",
            of("noise:7x5", Wrap::X, [3, 1], Boxes, 2.0, turned),
        ),
    ]
}

/// A shape made ready; how wide pixels are matters to none of these tests.
fn ready(shape: &HeightfieldSettings) -> Ready {
    Assets::default().ready(shape, 1e-3).unwrap()
}

fn local(placed: &Placement, eye: DVec3, ray: &Beam) -> LocalRay {
    LocalRay {
        origin: placed.position(eye + ray.origin),
        axis: placed.direction(ray.axis),
    }
}

/// Where every pixel's ray first meets the block, cell by cell; infinity for nowhere.
fn truths(plan: &Plan, ready: &Ready) -> Vec<f64> {
    let oracle = Oracle::new(ready.surface.clone());
    let view = plan.view();
    let [w, h] = plan.size;
    let one = |i: u32| {
        let ray = local(&ready.placement, view.eye, &view.view_ray([i % w, i / w]));
        let mut work = Default::default();
        let mut walk = oracle.begin(&ray, 0.0, 1e9, &mut work);
        let mut step = Step::Moving;
        while step == Step::Moving {
            step = oracle.step(&ray, &mut walk, &mut work);
        }
        if step == Step::Hit {
            walk.s
        } else {
            f64::INFINITY
        }
    };
    (0..w * h).into_par_iter().map(one).collect()
}

/// From above, along the ground beside it, and from next to the surface in the middle.
fn cameras(fov: f64) -> [Camera; 3] {
    let from = |eye: [f64; 3], target: [f64; 3]| Camera {
        eye: eye.into(),
        target: target.into(),
        up: DVec3::Z,
        fov,
    };
    [
        from([5.0, -9.0, 7.0], [0.0, 0.3, 0.5]),
        from([-13.0, 2.0, 1.1], [0.0, 0.0, 0.8]),
        from([0.3, 0.2, 3.4], [4.0, 3.0, 1.0]),
    ]
}

const LEVELS: Extras = Extras {
    count: false,
    normals: false,
    levels: true,
    depth_only: true,
    time: false,
};

#[test]
fn no_cell_starts_behind_a_relief_at_any_size_and_angle() {
    let mut nearest = 0.0_f64;
    for (name, shape) in shapes() {
        let ready = ready(&shape);
        let mut plan = Plan::new(Scene::Heightfield(shape));
        plan.march.coarsest = 32;
        plan.march.steps = Some(2048);
        for fov in [1.0, 48.5, 170.0] {
            for (n, camera) in cameras(fov).into_iter().enumerate() {
                plan.camera = camera;
                for size in [[1, 1], [97, 61], [33, 17], [1, 210], [200, 1]] {
                    plan.size = size;
                    let t = truths(&plan, &ready);
                    let here =
                        cpu::render(&plan, &Assets::default(), LEVELS, &mut |_| true).unwrap();
                    for frame in [here, adapter::render(&plan, LEVELS)] {
                        let what = format!("{name}, camera {n}, fov {fov}, {size:?}");
                        assert_eq!(frame.levels.len(), 5, "{what}");
                        assert_eq!(overclaims(&frame, &t), 0, "{what}");
                        nearest = nearest.max(brought_near(&frame, &t));
                    }
                }
            }
        }
    }
    // Nor do cells keep to the truth by claiming next to nothing.
    assert!(nearest > 0.8, "{nearest}");
}

/// Points all over what the block shows: its top, with the sides of boxes, its walls and
/// its base, so close together that none of the surface is farther off than `1 / fine`
/// texels or heights.
fn shell(relief: &HeightSurface, fine: i32) -> Vec<DVec3> {
    let [w, h] = relief.domain();
    let part = |i: i32| f64::from(i) / f64::from(fine);
    let mut all = Vec::new();
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        let corner = DVec3::new(f64::from(x), f64::from(y), 0.0);
        for (i, j) in (0..=fine).flat_map(|j| (0..=fine).map(move |i| (i, j))) {
            let (u, v) = (part(i), part(j));
            let top = relief.height([x, y], u, v);
            let base = corner + DVec3::new(u, v, 0.0);
            all.push(base + top * DVec3::Z);
            all.push(base);
            // Every cell's own four sides: those inside the block are no surface, unless
            // boxes are beside a lower one.
            let rim = [
                x == 0 && i == 0,
                x + 1 == w && i == fine,
                y == 0 && j == 0,
                y + 1 == h && j == fine,
            ];
            let edge = [[-1, 0], [1, 0], [0, -1], [0, 1]];
            let on = [i == 0, i == fine, j == 0, j == fine];
            for side in 0..4 {
                let beside = [x + edge[side][0], y + edge[side][1]];
                let boxes = relief.patches() == Patches::Boxes;
                let from = if rim[side] {
                    0.0
                } else if boxes && on[side] {
                    relief.apex(beside)
                } else {
                    top
                };
                let steps = (0..fine).map(|k| from + part(k) * (top - from));
                all.extend(steps.take_while(|z| *z < top).map(|z| base + z * DVec3::Z));
            }
        }
    }
    all
}

#[test]
fn empty_balls_hold_nothing_of_a_relief() {
    let mut random = Random::new(41);
    for (name, shape) in shapes() {
        let Ready {
            surface: relief,
            placement: placed,
            ..
        } = ready(&shape);
        let eye = DVec3::new(5.0, -9.0, 7.0);
        let mut plan = Plan::new(Scene::Heightfield(shape));
        plan.camera.eye = eye;
        let AnySolid::Heightfield(scene) = plan.solid(&Assets::default()).unwrap() else {
            unreachable!("a heightfield");
        };
        let world =
            |p: DVec3| placed.side(p * DVec3::new(placed.texel, placed.texel, placed.depth));
        let shell: Vec<DVec3> = shell(&relief, 6).into_iter().map(world).collect();
        let corner = eye - world(placed.position(eye));
        let [w, h] = relief.domain().map(f64::from);
        let points: Vec<DVec3> = (0..1500)
            .map(|i| {
                let n = [0; 3].map(|_| random.between(-0.15, 1.15));
                let p = DVec3::new(n[0] * w, n[1] * h, n[2]);
                // Every third from next to the surface on.
                let near = i % 3 == 0 && n[..2].iter().all(|n| (0.0..1.0).contains(n));
                let cell = [p.x as i32, p.y as i32];
                let top = if near {
                    relief.height(cell, p.x.fract(), p.y.fract())
                } else {
                    0.0
                };
                p.with_z(if near {
                    top + 0.2 * n[2] * n[2]
                } else {
                    2.0 * p.z
                })
            })
            .collect();
        let found: Vec<(f64, f64)> = points
            .par_iter()
            .map(|p| {
                let q = world(*p);
                let nearest = shell.iter().map(|s| s.distance_squared(q));
                let nearest = nearest.fold(f64::INFINITY, f64::min).sqrt();
                (scene.clearance(corner + q - eye), nearest)
            })
            .collect();
        for (p, (clear, nearest)) in points.iter().zip(&found) {
            assert!(
                *clear <= nearest + 1e-9,
                "{name}: {clear} for {nearest} at {p}"
            );
        }
        let large = found
            .iter()
            .filter(|(clear, nearest)| *clear > 0.3 * nearest);
        let large = large.count();
        assert!(large > 300, "{name}: only {large} balls of any size");
    }
}

/// The first of all boxes of a relief that a ray meets, and the normal of the side, in
/// local directions; each box is met by its three pairs of planes.
fn met(relief: &HeightSurface, ray: &LocalRay) -> Option<(f64, DVec3)> {
    let [w, h] = relief.domain();
    let mut first: Option<(f64, DVec3)> = None;
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        let low = DVec3::new(f64::from(x), f64::from(y), 0.0);
        let high = low + DVec3::new(1.0, 1.0, relief.apex([x, y]));
        let [a, b] = [
            (low - ray.origin) / ray.axis,
            (high - ray.origin) / ray.axis,
        ];
        let (near, far) = (a.min(b), a.max(b).min_element());
        let enter = near.max_element();
        if enter > 0.0 && enter < far && first.is_none_or(|(s, _)| enter < s) {
            let side = DVec3::AXES.into_iter().find(|n| near.dot(*n) == enter)?;
            first = Some((enter, -side * ray.axis.dot(side).signum()));
        }
    }
    first
}

#[test]
fn the_sides_of_boxes_face_sideways() {
    let shapes = shapes().into_iter();
    for (name, mut shape) in shapes.filter(|(_, s)| s.patches == Patches::Boxes) {
        for tracer in ["walk", "walk-relaxed", "max-mip", "walk-mip", "cone-mip"] {
            shape.tracing.tracer = tracer;
            let ready = ready(&shape);
            let mut plan = Plan::new(Scene::Heightfield(shape.clone()));
            [plan.camera, ..] = cameras(40.0);
            plan.size = [120, 80];
            let view = plan.view();
            let here = cpu::render(&plan, &Assets::default(), NORMALS, &mut |_| true).unwrap();
            for frame in [here, adapter::render(&plan, NORMALS)] {
                check_normals(&format!("{name}, {tracer}"), &frame, |pixel| {
                    let ray = local(&ready.placement, view.eye, &view.view_ray(pixel));
                    let (_, normal) = met(&ready.surface, &ray)?;
                    Some(ready.placement.side(normal))
                });
            }
        }
    }
}

/// Compares the normals of a frame with those of its rays, and sees that sides and tops
/// are among them.
fn check_normals(what: &str, frame: &Frame, normal: impl Fn([u32; 2]) -> Option<DVec3>) {
    let width = frame.size[0];
    let (mut wrong, mut seen) = (0, Vec::<(DVec3, u32)>::new());
    for i in (0..frame.state.len()).filter(|i| frame.state[*i] == HIT) {
        let own = DVec3::from_array(frame.normal[i].map(f64::from));
        let truth = normal([i as u32 % width, i as u32 / width]);
        wrong += u32::from(truth.is_none_or(|n| n.distance(own) > 1e-5));
        match seen.iter_mut().find(|(n, _)| n.distance(own) < 1e-5) {
            Some((_, count)) => *count += 1,
            None => seen.push((own, 1)),
        }
    }
    // Rays that meet an edge within a rounding: f32 takes either side.
    assert!(wrong <= 8, "{what}: {wrong} wrong, {seen:?}");
    let often = seen.iter().filter(|(_, count)| *count > 100).count();
    assert!(often >= 3, "{what}: {seen:?}");
}

/// A small map of noise that wraps along x, twice, painted by the cones of a generator.
fn painted(by: Generator, patches: Patches) -> HeightfieldSettings {
    let mut shape = HeightfieldSettings::default();
    shape.source.field = "noise:7x5,seed=3".into();
    shape.source.wrap = Wrap::X;
    shape.tiles = [2, 1];
    shape.patches = patches;
    shape.paint = Some(by);
    shape
}

/// Generators whose places are samples, four cones at each, or cells; and boxes.
const PAINTED: [(Generator, Patches); 4] = [
    (Generator::Exact, Patches::Bilinear),
    (Generator::Quad, Patches::Bilinear),
    (Generator::Walk, Patches::Bilinear),
    (Generator::Exact, Patches::Boxes),
];

#[test]
fn paint_is_how_wide_the_cones_are() {
    for (by, patches) in PAINTED {
        let shape = painted(by, patches);
        let Ready {
            surface: relief,
            placement: placed,
            ..
        } = ready(&shape);
        let heights = relief.heights();
        let map = generate(by, heights, patches, &Options::default(), &mut |_| true).unwrap();
        let plan = Plan::new(Scene::Heightfield(shape));
        let AnySolid::Heightfield(scene) = plan.solid(&Assets::default()).unwrap() else {
            unreachable!("a heightfield");
        };
        let eye = placed.position(plan.camera.eye);
        let units = DVec3::new(placed.texel, placed.texel, placed.depth);
        let [w, h] = relief.domain();
        let mut hues = Vec::new();
        // A quarter and three quarters into each cell, from above.
        for (i, j) in (0..2 * h).flat_map(|j| (0..2 * w).map(move |i| (i, j))) {
            let place = [i, j].map(|n| 0.25 + 0.5 * f64::from(n));
            let from = DVec3::new(place[0], place[1], 2.0);
            let ray = Beam {
                origin: placed.side((from - eye) * units),
                axis: -placed.side(DVec3::Z),
                r0: 0.0,
                k: 0.0,
                grain0: 0.0,
                grain: 0.0,
            };
            let mut work = Default::default();
            let mut walk = scene.begin(&ray, 0.0, f64::INFINITY, &mut work);
            while scene.walk_step(&ray, &mut walk, &mut work) == scene::Step::Moving {}
            let hue = scene.surface(&ray, &scene.walk_hit(&walk)).pigment.x;
            let round = by.over_cells() || patches == Patches::Boxes;
            let near = place.map(|n| if round { n.floor() } else { n.round() } as usize);
            let number = near[1] * map.size[0] as usize + near[0] % map.size[0] as usize;
            let cones = &map.ratios[number * by.channels()..][..by.channels()];
            let mean = cones.iter().sum::<f64>() / cones.len() as f64;
            let wanted = (mean / 7.0).min(1.0).sqrt();
            assert!(
                (hue - wanted).abs() < 1e-6,
                "{by:?}, {place:?}: {hue} for {wanted}"
            );
            hues.push((1e6 * hue) as u32);
        }
        hues.sort_unstable();
        hues.dedup();
        assert!(hues.len() > 5, "{by:?}: {} hues", hues.len());
    }
}

#[test]
fn both_executors_paint_alike() {
    for (by, patches) in PAINTED {
        let mut plan = Plan::new(Scene::Heightfield(painted(by, patches)));
        [plan.camera, ..] = cameras(40.0);
        plan.size = [120, 80];
        plan.look.palette_cycles = 1.0;
        let here =
            cpu::render(&plan, &Assets::default(), Extras::default(), &mut |_| true).unwrap();
        let there = adapter::render(&plan, Extras::default());
        let apart = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 0.02);
        let pairs = here.radiance.iter().zip(&there.radiance);
        let wrong = pairs.filter(|(a, b)| apart((a, b))).count();
        // Rays that meet the line between two places within a rounding take either.
        assert!(wrong <= 40, "{by:?}: {wrong} pixels apart");
    }
}

#[test]
fn depths_alone_need_no_map_to_paint_by() {
    let depths = Extras {
        depth_only: true,
        ..Extras::default()
    };
    let (by, patches) = PAINTED[0];
    let fresh = || {
        let mut plan = Plan::new(Scene::Heightfield(painted(by, patches)));
        plan.size = [64, 40];
        plan
    };
    let maps = |frame: &Frame| {
        frame
            .passes
            .iter()
            .filter(|p| matches!(p.pass, Pass::Prepare(_)))
            .count()
    };
    let said = |plan: &Plan, extras| {
        pass::explain(&plan, &Assets::default(), extras)
            .unwrap()
            .matches("prepare")
            .count()
    };
    for (extras, wanted) in [(Extras::default(), 2), (depths, 1)] {
        let plan = fresh();
        assert_eq!(
            said(&plan, extras),
            wanted,
            "{}",
            pass::explain(&plan, &Assets::default(), extras).unwrap()
        );
        let here = cpu::render(&plan, &Assets::default(), extras, &mut |_| true).unwrap();
        let there = adapter::render(&fresh(), extras);
        assert_eq!([maps(&here), maps(&there)], [wanted; 2]);
    }
    // A plan that has been rendered without its paint still has it.
    let plan = fresh();
    let without = cpu::render(&plan, &Assets::default(), depths, &mut |_| true).unwrap();
    let with = cpu::render(&plan, &Assets::default(), Extras::default(), &mut |_| true).unwrap();
    assert_eq!(without.depth, with.depth);
    let own = cpu::render(&fresh(), &Assets::default(), Extras::default(), &mut |_| {
        true
    })
    .unwrap();
    assert_eq!(with.radiance, own.radiance);
}

#[test]
fn halvings_find_the_sides_of_boxes_too() {
    let shapes = shapes().into_iter();
    for (name, mut shape) in shapes.filter(|(_, s)| s.patches == Patches::Boxes) {
        let mut rendered = |tracer| {
            shape.tracing.tracer = tracer;
            let mut plan = Plan::new(Scene::Heightfield(shape.clone()));
            [plan.camera, ..] = cameras(40.0);
            plan.size = [120, 80];
            let here = cpu::render(&plan, &Assets::default(), NORMALS, &mut |_| true).unwrap();
            [here, adapter::render(&plan, NORMALS)]
        };
        let truth = rendered("walk");
        for tracer in ["linear-binary", "csm-scaled", "rcs-binary", "secant"] {
            for (own, truth) in rendered(tracer).iter().zip(&truth) {
                // These tracers lose hits; where they have found the first one, they know
                // what they met.
                let both = |i: &usize| own.state[*i] == HIT && truth.state[*i] == HIT;
                let same = |i: &usize| (own.depth[*i] - truth.depth[*i]).abs() < 1e-4;
                let found: Vec<usize> = (0..own.state.len()).filter(both).filter(same).collect();
                let wrong = |i: &&usize| {
                    let [a, b] = [own, truth].map(|f| DVec3::from(f.normal[**i].map(f64::from)));
                    a.distance(b) > 1e-4
                };
                let wrong = found.iter().filter(wrong).count();
                assert!(found.len() > 500, "{name}, {tracer}: {} found", found.len());
                // Rays that meet an edge within a rounding.
                assert!(wrong <= 8, "{name}, {tracer}: {wrong} of {}", found.len());
            }
        }
    }
}
