//! Random plans that pass every check: any formula, heightfield and slab, camera, mode and setting, in
//! small pictures.

use conemarch::formula::Formula;
use conemarch::formula::balls::Balls;
use conemarch::formula::mandelbox::{Estimate, Mandelbox};
use conemarch::plan::Plan;
use conemarch::plan::camera::Camera;
use conemarch::plan::look::Look;
use conemarch::plan::march::{Marching, Mode};
use conemarch::scene::Scene;
use conemarch::scene::stepping::Relaxation;
use glam::DVec3;
use proptest::prelude::*;

use super::common::plans::{boxed, distance, scene};

/// A vector in the cube of a half extent.
fn cube(half: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-half..half).prop_map(DVec3::from_array)
}

/// A length of any size in a range: its logarithm is uniform.
fn size(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

/// Every sign and size of scale, radius, limit, rotation and constant.
fn mandelbox() -> impl Strategy<Value = Mandelbox> {
    let scale = (size(0.01, 9.0), any::<bool>());
    let turn = prop_oneof![Just(DVec3::ZERO), cube(180.0)];
    let lengths = (size(1e-5, 1.0), size(0.1, 10.0), size(0.1, 10.0));
    let julia = (any::<bool>(), cube(2.0));
    let estimate = prop_oneof![4 => Just(Estimate::Tight), 1 => Just(Estimate::Scalar), 1 => Just(Estimate::Classic)];
    (scale, lengths, turn, julia, estimate).prop_map(
        |((more, minus), (min, fixed, limit), rotation, (julia, constant), estimate)| Mandelbox {
            scale: if minus { -1.0 - more } else { 1.0 + more },
            min_radius: min * fixed,
            fixed_radius: fixed,
            fold_limit: limit,
            rotation,
            julia,
            julia_constant: constant * limit,
            estimate,
            lipschitz: None,
        },
    )
}

fn any_scene() -> impl Strategy<Value = Scene> {
    let iterations = prop_oneof![Just(None), (1_u32..=500).prop_map(Some)];
    let boxes = (mandelbox(), iterations).prop_map(|(m, most)| boxed(m, most));
    let balls = (size(1e-6, 0.5), 1e-3..1.2, 1e-3..2.5).prop_map(|(rod, edge, ball)| {
        let balls = Balls {
            rod_radius: rod,
            box_size: edge,
            ball_radius: ball,
        };
        distance(Formula::Balls(balls), None)
    });
    let slab = (size(1e-3, 1.0), size(0.1, 10.0));
    let slab = slab.prop_map(|(half, radius)| {
        scene(&format!(
            "kind = 'slab'\nhalf = {half:?}\nradius = {radius:?}"
        ))
    });
    prop_oneof![6 => boxes, 1 => balls, 1 => slab, 2 => heightfield()]
}

/// Small heightfields of every pattern, surface and exact tracer.
fn heightfield() -> impl Strategy<Value = Scene> {
    let pattern = prop::sample::select(&["fbm", "spikes", "checker", "noise"][..]);
    let tracer = prop::sample::select(&["walk", "walk-relaxed", "max-mip"][..]);
    let surface = prop::sample::select(&["bilinear", "boxes"][..]);
    let wrap = [
        ("none", [1, 1]),
        ("x", [2, 1]),
        ("y", [1, 2]),
        ("xy", [2, 2]),
    ];
    let wrap = prop::sample::select(wrap.to_vec());
    let source = (1_u32..=24, 1_u32..=24, 0_u32..100);
    let lengths = (size(1e-3, 1e2), size(1e-3, 1e2));
    (pattern, tracer, surface, wrap, source, lengths, cube(180.0)).prop_map(
        |(pattern, tracer, surface, (wrap, tiles), (w, h, seed), (width, depth), turn)| {
            // Needles a thousand times as high as wide are no picture of anything.
            let depth = depth.clamp(0.01 * width, 2.0 * width);
            scene(&format!(
                "kind = 'heightfield'\nfield = '{pattern}:{w}x{h},seed={seed}'\nwrap = '{wrap}'
                tiles = {tiles:?}\ntracer = '{tracer}'\nsurface = '{surface}'
                width = {width:?}\ndepth = {depth:?}\nturn = {:?}",
                turn.to_array()
            ))
        },
    )
}

/// An eye within, at or far from a subject of a size, looking near its middle.
fn camera(extent: f64) -> impl Strategy<Value = Camera> {
    let away = prop_oneof![
        3 => 0.0..1.0,
        4 => 1.0..4.0,
        1 => size(4.0, 1e6),
    ];
    let fov = prop_oneof![Just(1.0), Just(170.0), 1.0..170.0];
    (away, cube(1.0), cube(0.5), cube(1.0), fov).prop_map(move |(away, to, target, up, fov)| {
        Camera {
            eye: away * extent * to,
            target: extent * target,
            up,
            fov,
            ..Camera::default()
        }
    })
}

fn marching() -> impl Strategy<Value = Marching> {
    let mode = prop::sample::select(&Mode::ALL);
    let relaxation = prop_oneof![
        Just(Relaxation::Off),
        Just(Relaxation::Auto),
        (1.0..1.99).prop_map(Relaxation::Factor),
    ];
    let clip = prop::sample::select(vec![None, Some(true), Some(false)]);
    let numbers = (0_u32..=6, size(0.1, 10.0), 0.0..0.99, 1_u32..=300);
    (mode, numbers, relaxation, clip).prop_map(
        |(mode, (level, detail, shell, steps), relaxation, clip)| Marching {
            mode,
            coarsest: Some(1 << level),
            detail,
            shell: Some(shell),
            relaxation,
            steps: Some(steps),
            clip,
            ..Marching::default()
        },
    )
}

/// Two looks, for each is a program of its own: all of it, and next to none.
fn look() -> impl Strategy<Value = Look> {
    let plain = |light| Look {
        light,
        shadow: false,
        occlusion: 0.0,
        ..Look::default()
    };
    let full = |light| Look {
        light,
        fog: 0.5,
        ..Look::default()
    };
    prop_oneof![cube(1.0).prop_map(plain), cube(1.0).prop_map(full)]
}

/// Half the size of what a scene fills.
fn extent(scene: &Scene) -> f64 {
    match scene {
        Scene::Heightfield(settings) => 0.5 * settings.width,
        Scene::Slab(slab) => slab.radius,
        Scene::Distance(settings) => {
            let bounds = settings.formula.bounds();
            bounds.half.max_element().min(bounds.radius)
        }
    }
}

/// Any plan at all that passes its own check.
pub fn any_plan() -> impl Strategy<Value = Plan> {
    let sizes = prop_oneof![(1_u32..=40, 1_u32..=30), Just((40, 30))];
    let rest = move |scene: Scene| {
        let camera = camera(extent(&scene));
        (Just(scene), camera, marching(), look(), sizes.clone())
    };
    let plan = |(scene, camera, march, look, (w, h))| Plan {
        camera,
        march,
        look,
        size: [w, h],
        ..Plan::new(scene)
    };
    let checked = |plan: &Plan| plan.check().is_ok();
    let plans = any_scene().prop_flat_map(rest).prop_map(plan);
    plans.prop_filter("a plan that its own check refuses", checked)
}
