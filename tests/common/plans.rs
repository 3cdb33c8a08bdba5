//! How tests make plans, and ask them for what is behind them. Tests know the interface of
//! plans and scenes only through this file and `adapter`.

use conemarch::base::key::Kind;
use conemarch::base::shader::Program;
use conemarch::formula::Formula;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::measure::compare::{Report, compare};
use conemarch::pass::look::Light;
use conemarch::pass::{self, LookFeature};
use conemarch::picture::frame::Frame;
use conemarch::plan::camera::Camera;
use conemarch::plan::{Extras, Pass, Plan};
use conemarch::preset::{BUILTIN, Override, load};
use conemarch::scene::distance::Distance;
use conemarch::scene::distance_settings::DistanceSettings;
use conemarch::scene::{AnySolid, Assets, Scene};
use glam::DVec3;

/// The plan of a built-in preset, with settings as `--set` takes them, and with cones. Pictures as
/// small as those of tests have cones only if they are asked for.
pub fn preset(name: &str, settings: &[&str]) -> Plan {
    let read = |text: &&str| Override::read(text).expect("section.key=value");
    let settings = ["march.coarsest=16"].iter().chain(settings).map(read);
    let settings: Vec<Override> = settings.collect();
    let preset = load(name, &settings);
    let plan = preset.unwrap_or_else(|e| panic!("{name}: {e}")).plan;
    plan.one_sample()
}

/// The views that are measured.
pub fn bench_views() -> impl Iterator<Item = &'static str> {
    let names = BUILTIN.iter().map(|(name, _)| *name);
    names.filter(|name| name.starts_with("bench-"))
}

/// The plan of a built-in preset at another size.
pub fn sized(name: &str, [w, h]: [u32; 2]) -> Plan {
    preset(name, &[&format!("image.size=[{w}, {h}]")])
}

/// A scene without a formula, given by the keys of its section. Nothing is checked but the
/// range of each value.
pub fn scene(keys: &str) -> Scene {
    let mut table: toml::Table = keys.parse().unwrap_or_else(|e| panic!("{keys}: {e}"));
    let kind = table.remove("kind").expect("a kind");
    let mut scenes = Scene::all().into_iter();
    let scene = scenes.find(|s| Some(s.kind()) == kind.as_str());
    let mut scene = scene.expect("a kind of scene");
    for (name, value) in table {
        let mut keys = scene.keys();
        let key = keys.iter_mut().find(|key| key.name == name);
        let set = key.expect("a key of the scene").slot.set(&value);
        set.unwrap_or_else(|e| panic!("{name} = {value}: {e}"));
    }
    scene
}

/// A scene of a formula with its own iteration limit, or the automatic one.
pub fn distance(formula: Formula, iterations: Option<u32>) -> Scene {
    Scene::Distance(DistanceSettings {
        formula,
        iterations,
    })
}

/// The same for a Mandelbox.
pub fn boxed(m: Mandelbox, iterations: Option<u32>) -> Scene {
    distance(Formula::Mandelbox(m), iterations)
}

/// A camera that looks at a point, +z up.
pub fn camera(eye: impl Into<DVec3>, target: impl Into<DVec3>) -> Camera {
    Camera {
        eye: eye.into(),
        target: target.into(),
        up: DVec3::Z,
        fov: 48.5,
        ..Camera::default()
    }
}

/// The Mandelbox of a scale.
pub fn mandelbox(scale: f64) -> Mandelbox {
    Mandelbox {
        scale,
        ..Mandelbox::default()
    }
}

/// The settings of a plan of a formula.
fn settings(plan: &mut Plan) -> &mut DistanceSettings {
    match &mut plan.scene {
        Scene::Distance(settings) => settings,
        _ => panic!("a plan of a formula"),
    }
}

/// The Mandelbox of a plan.
pub fn mandelbox_of(plan: &mut Plan) -> &mut Mandelbox {
    match &mut settings(plan).formula {
        Formula::Mandelbox(m) => m,
        _ => panic!("a plan of a Mandelbox"),
    }
}

/// Gives a plan of a formula its own iteration limit.
pub fn limit_iterations(plan: &mut Plan, most: u32) {
    settings(plan).iterations = Some(most);
}

/// Switches a feature of the look by its own keys: to 1 and `true`, or to 0 and `false`.
pub fn switch(plan: &mut Plan, feature: LookFeature, on: bool) {
    for name in feature.keys() {
        let mut keys = plan.look.keys();
        let key = keys.iter_mut().find(|key| key.name == *name);
        let slot = &mut key.unwrap_or_else(|| panic!("no key {name}")).slot;
        let value = match slot.kind() {
            Kind::Switch => on.into(),
            _ => f64::from(u8::from(on)).into(),
        };
        slot.set(&value)
            .unwrap_or_else(|e| panic!("{name} must take 0 and 1, and expects {e}"));
    }
}

/// Sets what a feature of the look needs besides its own keys.
pub fn allow(plan: &mut Plan, feature: LookFeature) {
    plan.look.mode = feature.mode().unwrap_or(plan.look.mode);
    if let Some(needed) = feature.needs() {
        allow(plan, needed);
        switch(plan, needed, true);
    }
}

/// Switches all features of the look off.
pub fn switch_all_off(plan: &mut Plan) {
    for feature in LookFeature::ALL {
        switch(plan, *feature, false);
    }
}

/// The scene of a plan in numbers, ready to be asked.
pub fn solid(plan: &Plan) -> AnySolid {
    let solid = plan.scene.solid(&plan.viewpoint(), &Assets::default());
    solid.unwrap_or_else(|e| panic!("{e}, {plan:?}"))
}

/// The same without what takes long to make; its programs are the same.
pub fn outline(plan: &Plan, assets: &Assets) -> AnySolid {
    let solid = plan.scene.outline(&plan.viewpoint(), assets);
    solid.unwrap_or_else(|e| panic!("{e}, {plan:?}"))
}

/// The same for a plan of a formula.
pub fn distance_solid(plan: &Plan) -> Distance {
    match solid(plan) {
        AnySolid::Distance(scene) => scene,
        _ => panic!("a plan of a formula"),
    }
}

/// The light of a plan.
pub fn light(plan: &Plan) -> Light {
    Light::of(plan, &solid(plan))
}

/// The report on a frame of a plan against a reference.
pub fn compared(frame: &Frame, reference: &Frame, plan: &Plan) -> Report {
    compare(frame, reference, plan, &solid(plan))
}

/// The program of a pass.
pub fn program(plan: &Plan, solid: &AnySolid, pass: Pass, extras: Extras) -> Program {
    pass::program(plan, solid, pass, extras)
}

/// What `--explain` prints.
pub fn explain(plan: &Plan, extras: Extras) -> String {
    pass::explain(plan, &Assets::default(), extras).expect("an explanation")
}
