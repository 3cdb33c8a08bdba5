//! Scenes and views to ask the shaders about, and questions for them.

use bytemuck::bytes_of;
use conemarch::base::shader::Module;
use conemarch::base::view;
use conemarch::base::view::Beam;
use conemarch::formula::balls::Balls;
use conemarch::formula::mandelbox::{Estimate, Mandelbox};
use conemarch::formula::{DistanceEstimate, Formula};
use conemarch::heightfield::settings::HeightfieldSettings;
use conemarch::pass::look::Light;
use conemarch::pass::{self, LookFeature};
use conemarch::plan::Plan;
use conemarch::scene::Assets;
use conemarch::scene::distance::DistanceSettings;
use conemarch::scene::slab::SlabSettings;
use conemarch::scene::{AnySolid, Scene, Solid};
use conemarch::wgsl;
use glam::DVec3;

use super::probe::{Numbers, Probe};
use super::random::Random;

/// What is multiplied into a constant to show that a check sees it.
pub const MOVED: f64 = 1.0001;

/// f64 to f32, and back: what both sides are asked is the same number.
#[allow(clippy::cast_possible_truncation, reason = "what the GPU takes")]
pub fn narrow(x: f64) -> f64 {
    f64::from(x as f32)
}

/// Four numbers of a question.
#[allow(clippy::cast_possible_truncation, reason = "narrowed before")]
pub fn four(v: DVec3, w: f64) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, w as f32]
}

/// The three first numbers of four, as f64.
pub fn three(v: [f32; 4]) -> DVec3 {
    DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]))
}

/// A plan that looks at a subject from an eye.
pub fn plan(subject: Scene, eye: DVec3) -> Plan {
    let mut plan = Plan::new(subject);
    plan.camera.eye = eye;
    plan.size = [320, 200];
    plan
}

/// A plan of a shape.
pub fn shape_plan(shape: Formula, iterations: u32, eye: DVec3) -> Plan {
    let iterations = Some(iterations);
    plan(
        Scene::Distance(DistanceSettings {
            formula: shape,
            iterations,
        }),
        eye,
    )
}

/// A plan of the slab.
pub fn slab_plan(shape: SlabSettings) -> Plan {
    plan(Scene::Slab(shape), DVec3::new(4.0, -9.0, 6.0))
}

/// A small heightfield, seen from the same place.
pub fn heightfield_plan(depth: f64) -> Plan {
    let mut shape = HeightfieldSettings::default();
    shape.depth = depth;
    shape.turn = DVec3::new(5.0, -8.0, 30.0);
    shape.source.field = "fbm:33x25,seed=3,power=3".into();
    plan(Scene::Heightfield(shape), DVec3::new(4.0, -9.0, 6.0))
}

/// The Mandelboxes that are asked about, by name.
pub fn mandelboxes() -> Vec<(&'static str, Mandelbox)> {
    let of = |scale| Mandelbox {
        scale,
        ..Mandelbox::default()
    };
    let rotated = Mandelbox {
        rotation: DVec3::new(20.0, -35.0, 50.0),
        ..of(2.0)
    };
    let julia = Mandelbox {
        julia: true,
        julia_constant: DVec3::new(0.7, -0.4, 1.1),
        ..of(2.0)
    };
    let classic = Mandelbox {
        estimate: Estimate::Classic,
        ..of(2.0)
    };
    vec![
        ("scale 2", of(2.0)),
        ("scale -1.5", of(-1.5)),
        ("scale 3", of(3.0)),
        ("rotated", rotated),
        ("julia", julia),
        ("classic", classic),
    ]
}

/// Balls with the radius of the largest multiplied.
pub fn balls(factor: f64) -> Formula {
    Formula::Balls(Balls {
        ball_radius: factor,
        box_size: 0.7 * factor,
        rod_radius: 0.05 * factor,
    })
}

/// The scene of a plan with all that passes join to it, and a probe into it.
pub fn probe_of(plan: &Plan, probe: Module) -> Probe {
    let scene = plan.solid(&Assets::default()).unwrap();
    let mut modules = scene.twin().modules();
    modules.extend([
        view::module(),
        wgsl!("pass/shared.wgsl"),
        wgsl!("base/counters_off.wgsl"),
        probe,
    ]);
    let mut parameters = scene.twin().uniforms();
    parameters.push(view_parameter(plan));
    Probe {
        modules,
        parameters,
    }
}

/// The same with the look and its features.
pub fn lit_probe_of(plan: &Plan, probe: Module) -> Probe {
    let mut all = probe_of(plan, probe);
    all.modules.push(pass::look::module());
    all.modules
        .extend(LookFeature::ALL.iter().map(|f| f.module(true)));
    all.parameters.push(look_parameter(plan));
    all
}

/// The view of a plan as WGSL reads it.
pub fn view_parameter(plan: &Plan) -> (&'static str, Vec<u8>) {
    let view = plan.view().uniform([0, 0], plan.size);
    ("view_parameters", bytes_of(&view).to_vec())
}

/// The look of a plan as WGSL reads it.
pub fn look_parameter(plan: &Plan) -> (&'static str, Vec<u8>) {
    (
        "look_parameters",
        bytes_of(&Light::of(&plan, &Assets::default()).uniform()).to_vec(),
    )
}

/// Points in and about the bounds of a formula.
pub fn points(formula: &dyn DistanceEstimate, iterations: u32, seed: u64) -> Vec<Numbers> {
    let bounds = formula.bounds();
    let mut random = Random::new(seed);
    let reach = 1.2 * bounds.half.max_element().min(bounds.radius);
    let most = f64::from(iterations);
    let of = |_| [four(random.cube(reach), most), [0.0; 4], [0.0; 4]];
    (0..8192).map(of).collect()
}

/// Beams from near the eye towards points about the origin: origin and front, axis and
/// chord, r0, grain, `t_max` and steps.
pub fn beams(plan: &Plan, spread: f64, steps: f64, seed: u64) -> Vec<Numbers> {
    let mut random = Random::new(seed);
    let far = match plan.solid(&Assets::default()).unwrap() {
        AnySolid::Distance(s) => s.bounds_far(),
        AnySolid::Heightfield(s) => s.bounds_far(),
        AnySolid::Slab(s) => s.bounds_far(),
    };
    let of = |_| {
        let origin = random.cube(0.01);
        let axis = (random.cube(spread) - plan.camera.eye).normalize();
        let front = far * random.between(0.0, 0.45);
        let (k, r0) = (random.between(0.0, 0.1), random.between(0.0, 0.02));
        let grain = random.between(0.001, 0.01);
        let end = random.between(0.8, 2.0) * far;
        [
            four(origin, front),
            four(axis, k),
            four(DVec3::new(r0, grain, end), steps),
        ]
    };
    (0..8192).map(of).collect()
}

/// The beam of a question.
pub fn beam(q: &Numbers) -> Beam {
    Beam {
        origin: three(q[0]),
        axis: three(q[1]),
        r0: f64::from(q[2][0]),
        k: f64::from(q[1][3]),
        grain0: 0.0,
        grain: f64::from(q[2][1]),
    }
}
