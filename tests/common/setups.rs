//! What is joined and bound to ask the shaders about a plan, and questions for them.

use bytemuck::bytes_of;
use conemarch::base::outcome;
use conemarch::base::shader::Module;
use conemarch::formula::Formula;
use conemarch::plan::Plan;
use conemarch::scene::Scene;
use conemarch::wgsl;
use glam::DVec3;

use super::plans::{distance, solid};
use super::probe::Probe;

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

/// A plan that looks at a scene from an eye.
pub fn seen_from(eye: impl Into<DVec3>, scene: Scene) -> Plan {
    let mut plan = Plan::new(scene).one_sample();
    // The details of its own pixels.
    plan.reference = None;
    plan.camera.eye = eye.into();
    plan.size = [320, 200];
    plan
}

/// The probe of a formula's estimate and traps.
pub fn formula_probe(formula: Formula, iterations: u32) -> Probe {
    let plan = seen_from([9.0, 0.0, 0.0], distance(formula, Some(iterations)));
    probe_of(&plan, super::probe::probe!("formula"))
}

/// The scene of a plan with all that passes join to it, and a probe into it.
pub fn probe_of(plan: &Plan, probe: Module) -> Probe {
    let solid = solid(plan);
    let mut modules = solid.twin().modules();
    modules.extend(plan.view().modules());
    modules.extend(outcome::modules(false));
    modules.extend([
        wgsl!("scene/contract.wgsl"),
        wgsl!("pass/shared.wgsl"),
        probe,
    ]);
    let mut parameters = solid.twin().uniforms();
    let arrays = solid.twin().arrays();
    parameters.extend(arrays.iter().map(|array| (array.name, array.bytes())));
    let view = plan.view().uniform();
    parameters.push(("view_parameters", bytes_of(&view).to_vec()));
    Probe {
        modules,
        parameters,
    }
}
