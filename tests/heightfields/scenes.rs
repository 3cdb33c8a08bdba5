//! Heightfields as scenes, on both executors: cones never start behind a surface at any size and
//! angle of view, and empty balls are empty.

use conemarch::base::view::Beam;
use conemarch::heightfield::assets::Ready;
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::placement::Placement;
use conemarch::heightfield::tracer::{LocalRay, Tracer};
use conemarch::measure::tracer_stats::first_hits;
use conemarch::plan::Plan;
use conemarch::scene::heightfield::Heightfield;
use conemarch::scene::{AnySolid, Assets, Scene, Solid};
use glam::DVec3;
use rayon::prelude::*;

use crate::adapter::{COUNTED, HIT, LEVELS, NORMALS};
use crate::common::overclaims::{brought_near, overclaims};
use crate::common::random::Random;
use crate::{both, camera, plan};

/// Heightfields of every kind: rough and smooth, ended, wrapped and tiled, as they lie and turned,
/// patches and boxes.
pub const SCENES: [&str; 7] = [
    "field = 'fbm:65x48,seed=5,power=3'\ndepth = 2.6",
    "field = 'ridges:33x40'\ndepth = 3\nturn = [25, -40, 60]",
    "field = 'spikes:40x40'\ndepth = 4",
    "field = 'spikes:24x17'\ndepth = 4\nsurface = 'boxes'",
    "field = 'fbm:31x24'\nwrap = 'y'\nturn = [25, -40, 60]",
    "field = 'stones:16x11'\nwrap = 'xy'\ntiles = [2, 3]\ndepth = 1.5",
    "field = 'noise:7x5'\nwrap = 'x'\ntiles = [3, 1]\nturn = [25, -40, 60]\nsurface = 'boxes'",
];

/// What a plan's heightfield consists of. How wide pixels are does not matter to these tests.
pub fn ready(plan: &Plan) -> Ready {
    let Scene::Heightfield(settings) = &plan.scene else {
        panic!("no heightfield");
    };
    Assets::default().heightfield.ready(settings, 1e-3).unwrap()
}

/// The scene of a plan in f64.
pub fn solid(plan: &Plan) -> Heightfield {
    match plan
        .scene
        .solid(&plan.viewpoint(), &Assets::default())
        .unwrap()
    {
        AnySolid::Heightfield(solid) => solid,
        _ => panic!("no heightfield"),
    }
}

/// A ray of the view in local units.
pub fn local(placement: &Placement, eye: DVec3, ray: &Beam) -> LocalRay {
    LocalRay {
        origin: placement.position(eye + ray.origin),
        axis: placement.direction(ray.axis),
    }
}

/// Where every pixel's ray first meets the block, cell by cell; infinity for nowhere.
fn truths(plan: &Plan, ready: &Ready) -> Vec<f64> {
    let view = plan.view();
    let [w, h] = plan.size;
    let pixels = (0..w * h).map(|i| view.view_ray([i % w, i / w]));
    let rays = pixels.map(|ray| local(&ready.placement, view.eye, &ray));
    let rays: Vec<_> = rays.collect();
    let hits = first_hits(&Tracer::reference(ready.surface.clone()), &rays).into_iter();
    hits.map(|s| s.unwrap_or(f64::INFINITY)).collect()
}

#[test]
fn no_cell_starts_behind_a_surface_at_any_size_and_angle() {
    // From above, along the ground beside it, and from next to the surface in the middle.
    let views = [
        ([5.0, -9.0, 7.0], [0.0, 0.3, 0.5]),
        ([-13.0, 2.0, 1.1], [0.0, 0.0, 0.8]),
        ([0.3, 0.2, 3.4], [4.0, 3.0, 1.0]),
    ];
    let mut nearest = 0.0_f64;
    for scene in SCENES {
        let mut plan = plan(scene);
        let ready = ready(&plan);
        plan.march.coarsest = Some(32);
        plan.march.steps = Some(2048);
        for fov in [1.0, 48.5, 170.0] {
            for (eye, target) in views {
                plan.camera = camera(eye, target, fov);
                for size in [[1, 1], [97, 61], [33, 17], [1, 210], [200, 1]] {
                    plan.size = size;
                    let t = truths(&plan, &ready);
                    for frame in both(&plan, LEVELS) {
                        let what = format!("{scene}, from {eye:?}, fov {fov}, {size:?}");
                        assert_eq!(frame.levels.len(), 5, "{what}");
                        assert_eq!(overclaims(&frame, plan.camera.eye, &t), [], "{what}");
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
fn shell(surface: &HeightSurface, fine: i32) -> Vec<DVec3> {
    let [w, h] = surface.domain();
    let part = |i: i32| f64::from(i) / f64::from(fine);
    let mut all = Vec::new();
    for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
        let corner = DVec3::new(f64::from(x), f64::from(y), 0.0);
        for (i, j) in (0..=fine).flat_map(|j| (0..=fine).map(move |i| (i, j))) {
            let (u, v) = (part(i), part(j));
            let top = surface.height([x, y], u, v);
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
                let boxes = surface.patches() == Patches::Boxes;
                let from = if rim[side] {
                    0.0
                } else if boxes && on[side] {
                    surface.apex(beside)
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
fn empty_balls_hold_nothing_of_a_surface() {
    let mut random = Random::new(41);
    for name in SCENES {
        let plan = plan(name);
        let Ready {
            surface, placement, ..
        } = ready(&plan);
        let eye = plan.camera.eye;
        let scene = solid(&plan);
        let world = |p: DVec3| {
            placement.side(p * DVec3::new(placement.texel, placement.texel, placement.depth))
        };
        let shell: Vec<DVec3> = shell(&surface, 6).into_iter().map(world).collect();
        let corner = eye - world(placement.position(eye));
        let [w, h] = surface.domain().map(f64::from);
        let points: Vec<DVec3> = (0..1500)
            .map(|i| {
                let n = [0; 3].map(|_| random.between(-0.15, 1.15));
                let p = DVec3::new(n[0] * w, n[1] * h, n[2]);
                // Every third from next to the surface on.
                if i % 3 == 0 && n[..2].iter().all(|n| (0.0..1.0).contains(n)) {
                    let cell = [p.x as i32, p.y as i32];
                    let top = surface.height(cell, p.x.fract(), p.y.fract());
                    return p.with_z(top + 0.2 * n[2] * n[2]);
                }
                p.with_z(2.0 * p.z)
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
            let empty = *clear <= nearest + 1e-9;
            assert!(empty, "{name}: {clear} for {nearest} at {p}");
        }
        let large = |(clear, nearest): &&(f64, f64)| *clear > 0.3 * nearest;
        let large = found.iter().filter(large).count();
        assert!(large > 300, "{name}: only {large} balls of any size");
    }
}

/// Half a pixel is up to a texel wide in the small picture and a ninth of it in the large one. The
/// centre of every small pixel is also the centre of a large one, so the light there is the same.
#[test]
fn shadows_do_not_change_with_the_size_of_the_picture() {
    for scene in SCENES {
        let mut plan = plan(scene);
        plan.look.light_size = 0.05;
        plan.look.occlusion = 0.0;
        plan.look.light = DVec3::new(0.7, 0.3, 0.25);
        // Each picture has pixels of its own.
        plan.reference = None;
        let large = [81, 63];
        plan.size = large.map(|n| 9 * n);
        let fine = both(&plan, NORMALS);
        plan.size = large;
        let coarse = both(&plan, NORMALS);
        for (fine, coarse) in fine.iter().zip(&coarse) {
            let (mut seen, mut changed) = (0, 0);
            for (i, own) in coarse.radiance.iter().enumerate() {
                let [x, y] = [i % large[0] as usize, i / large[0] as usize];
                let j = (9 * y + 4) * fine.size[0] as usize + 9 * x + 4;
                if coarse.normal[i] == fine.normal[j] && coarse.state[i] == HIT {
                    seen += 1;
                    let other = &fine.radiance[j];
                    changed += usize::from((own[0] - other[0]).abs() > 0.1 * other[0]);
                }
            }
            assert!(seen > 300, "{scene}: {seen}");
            assert!(changed * 250 <= seen, "{scene}: {changed} of {seen}");
        }
    }
}

/// Tiles whose sides are no powers of two end with narrow nodes. There a step can be shorter than
/// the roundings of f32.
#[test]
fn cones_over_odd_tiles_do_not_stand_still() {
    for field in ["fbm:100x100", "fbm:5x5", "stones:7x100"] {
        let scene = format!("field = '{field}'\nwrap = 'xy'\ntiles = [4, 4]\ndepth = 1.4");
        let mut plan = plan(&scene);
        plan.size = [64, 36];
        let works = both(&plan, COUNTED).map(|frame| {
            let marched = frame.passes.iter().filter_map(|pass| pass.evaluations);
            marched.collect::<Vec<_>>()
        });
        for (own, exact) in works[0].iter().zip(&works[1]) {
            let most = 2 * own.min(exact) + 500;
            assert!(own.max(exact) < &most, "{field}: {works:?}");
        }
    }
}
