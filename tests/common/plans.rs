//! How tests make plans, and ask them for what is behind them. Tests know the interface of
//! plans and scenes only through this file and `adapter`.

use conemarch::base::shader::Program;
use conemarch::formula::Formula;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::plan::camera::Camera;
use conemarch::plan::{Extras, Pass, Plan};
use conemarch::preset::{Override, load, read};
use conemarch::scene::distance::Distance;
use glam::DVec3;

pub use conemarch::plan::Subject as Scene;
pub use conemarch::scene::Scene as AnySolid;

/// The plan of a built-in preset, with settings as `--set` takes them.
pub fn preset(name: &str, settings: &[&str]) -> Plan {
    let read = |text: &&str| Override::read(text).expect("section.key=value");
    let settings: Vec<Override> = settings.iter().map(read).collect();
    let preset = load(name, &settings);
    preset.unwrap_or_else(|e| panic!("{name}: {e}")).plan
}

/// The plan of a built-in preset at another size.
pub fn sized(name: &str, [w, h]: [u32; 2]) -> Plan {
    preset(name, &[&format!("image.size=[{w}, {h}]")])
}

/// A scene, given by the keys of its section.
pub fn scene(keys: &str) -> Scene {
    let plan = read(&format!("[scene]\n{keys}\n"), "a scene");
    plan.unwrap_or_else(|e| panic!("{keys}: {e}")).subject
}

/// A scene of a formula with its own iteration limit, or the automatic one.
pub fn distance(formula: impl Into<AnyFormula>, iterations: Option<u32>) -> Scene {
    let shape = formula.into().0;
    Scene::Distance { shape, iterations }
}

/// A formula, or what can be made one.
pub struct AnyFormula(Formula);

impl From<Formula> for AnyFormula {
    fn from(formula: Formula) -> Self {
        Self(formula)
    }
}

impl From<Mandelbox> for AnyFormula {
    fn from(m: Mandelbox) -> Self {
        Self(Formula::Mandelbox(m))
    }
}

/// A camera that looks at a point, +z up.
pub fn camera(eye: impl Into<DVec3>, target: impl Into<DVec3>) -> Camera {
    Camera {
        eye: eye.into(),
        target: target.into(),
        up: DVec3::Z,
        fov: 48.5,
    }
}

/// The Mandelbox of a scale.
pub fn mandelbox(scale: f64) -> Mandelbox {
    Mandelbox {
        scale,
        ..Mandelbox::default()
    }
}

/// The formula of a plan, if it has one.
pub fn formula_of(plan: &Plan) -> Option<&Formula> {
    match &plan.subject {
        Scene::Distance { shape, .. } => Some(shape),
        _ => None,
    }
}

/// The Mandelbox of a plan.
pub fn mandelbox_of(plan: &mut Plan) -> &mut Mandelbox {
    match &mut plan.subject {
        Scene::Distance {
            shape: Formula::Mandelbox(m),
            ..
        } => m,
        _ => panic!("a plan of a Mandelbox"),
    }
}

/// Gives a plan of a formula its own iteration limit.
pub fn limit_iterations(plan: &mut Plan, most: u32) {
    if let Scene::Distance { iterations, .. } = &mut plan.subject {
        *iterations = Some(most);
    }
}

/// The scene of a plan in numbers, ready to be asked.
pub fn solid(plan: &Plan) -> AnySolid {
    plan.scene()
}

/// The same for a plan of a formula.
pub fn distance_solid(plan: &Plan) -> Distance {
    match solid(plan) {
        AnySolid::Distance(scene) => scene,
        _ => panic!("a plan of a formula"),
    }
}

/// The passes of a frame with extras.
pub fn passes(plan: &Plan, extras: Extras) -> Vec<Pass> {
    plan.passes_for(extras)
}

/// The program of a pass.
pub fn program(plan: &Plan, solid: &AnySolid, pass: Pass, extras: Extras) -> Program {
    plan.program(solid, pass, extras)
}

/// What `--explain` prints.
pub fn explain(plan: &Plan, extras: Extras) -> String {
    plan.explain(extras)
}
