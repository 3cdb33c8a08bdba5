//! Every plan whose shaders can differ: presets, subjects with each key moved, all modes,
//! and looks with and without their features.

use conemarch::pass;
use conemarch::scene::Assets;
use conemarch::scene::Scene;
use conemarch::scene::distance::DistanceSettings;
use std::collections::BTreeMap;

use conemarch::base::shader::Program;
use conemarch::formula::Formula;
use conemarch::formula::mandelbox::{Estimate, Mandelbox};
use conemarch::heightfield::conemap::generate;
use conemarch::plan::march::MODES;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{BUILTIN, builtin, read};
use glam::DVec3;
use toml::Value;

/// The plan of a built-in preset.
pub fn preset(name: &str) -> Plan {
    let text = builtin(name).expect("the preset is built in");
    read(text, name).expect("a built-in preset reads")
}

/// A subject for a shape.
pub fn distance(shape: Formula) -> Scene {
    let iterations = None;
    Scene::Distance(DistanceSettings {
        formula: shape,
        iterations,
    })
}

/// All values worth trying for a key: the other states of a switch, every word of a
/// list of words, and a triple away from zero.
fn values(now: &Value, expects: &str) -> Vec<Value> {
    match now {
        Value::Boolean(b) => vec![Value::Boolean(!b)],
        Value::Array(list) if list.len() == 3 => {
            vec![Value::Array([3.0, 5.0, 7.0].map(Value::Float).to_vec())]
        }
        Value::String(_) => {
            let quoted = expects.split('"').skip(1).step_by(2);
            quoted.map(|w| Value::String(w.into())).collect()
        }
        _ => Vec::new(),
    }
}

/// The subject itself, and once more for each value of each of its keys that could
/// choose a feature.
fn with_each_key_moved(subject: &Scene) -> Vec<Scene> {
    let mut all = vec![subject.clone()];
    let count = subject.clone().keys().len();
    for index in 0..count {
        let mut copy = subject.clone();
        let tried = {
            let key = &copy.keys()[index];
            values(&key.slot.get(), &key.slot.expects())
        };
        for value in tried {
            let mut moved = subject.clone();
            if moved.keys()[index].slot.set(&value).is_ok() {
                all.push(moved);
            }
        }
    }
    all
}

/// Mandelboxes with every combination of rotation, Julia mode and estimate.
fn mandelboxes() -> Vec<Mandelbox> {
    let mut all = Vec::new();
    for bits in 0..8_u32 {
        all.push(Mandelbox {
            rotation: f64::from(bits & 1) * DVec3::new(20.0, -35.0, 50.0),
            julia: bits & 2 > 0,
            julia_constant: DVec3::new(0.7, -0.4, 1.1),
            estimate: if bits & 4 > 0 {
                Estimate::Classic
            } else {
                Estimate::Proven
            },
            ..Mandelbox::default()
        });
    }
    all
}

/// Everything that can be in a picture, with its features.
fn subjects() -> Vec<Scene> {
    let mut all = Scene::all();
    for subject in &mut all {
        // Small: what is joined does not depend on how many samples there are.
        if let Scene::Heightfield(shape) = subject {
            shape.source.field = "fbm:16x16".into();
        }
    }
    let mut moved: Vec<Scene> = all.iter().flat_map(with_each_key_moved).collect();
    let boxes = mandelboxes().into_iter();
    moved.extend(boxes.map(|m| distance(Formula::Mandelbox(m))));
    // Few iterations and many: what could overflow is guarded.
    for shape in Formula::all() {
        for count in [2, 1000] {
            let iterations = Some(count);
            let shape = shape.clone();
            moved.push(Scene::Distance(DistanceSettings {
                formula: shape,
                iterations,
            }));
        }
    }
    moved
}

/// All plans: presets and subjects, in every mode and with every feature of the look. A
/// heightfield has so many tracers that its modes and its looks are tried apart.
fn plans() -> Vec<Plan> {
    let presets = BUILTIN.iter().map(|(name, _)| preset(name));
    let first: Vec<Plan> = presets
        .chain(subjects().into_iter().map(Plan::new))
        .collect();
    let mut all = Vec::new();
    for plan in &first {
        for (_, mode) in MODES {
            for look in 0..8 {
                let apart = matches!(plan.scene, Scene::Heightfield(_));
                if apart && look > 0 && *mode != plan.march.mode {
                    continue;
                }
                let mut one = plan.clone();
                one.march.mode = *mode;
                one.look.shadow = look & 1 > 0;
                one.look.occlusion = if look & 2 > 0 { 1.0 } else { 0.0 };
                one.look.fog = if look & 4 > 0 { 0.5 } else { 0.0 };
                all.push(one);
            }
        }
    }
    all
}

/// All different programs of a plan's passes, with work counted or not and normals
/// kept or not.
pub fn programs_of(plan: &Plan) -> Vec<Program> {
    let scene = plan.solid(&Assets::default()).unwrap();
    let mut all: Vec<Program> = Vec::new();
    for pass in plan.passes(Extras::default()) {
        for bits in 0..4 {
            let extras = Extras {
                count: bits & 1 > 0,
                normals: bits & 2 > 0,
                ..Extras::default()
            };
            let program = pass::program(&plan, &scene, pass, extras);
            if !all.contains(&program) {
                all.push(program);
            }
        }
    }
    all
}

/// All different programs, each under its entry and listing: of plans, and of the
/// generators of cone maps.
pub fn every_program() -> BTreeMap<String, Program> {
    let mut all = BTreeMap::new();
    for program in generate::task::every_program() {
        let listing = format!("{}\n{}", program.entry, program.describe());
        all.entry(listing).or_insert(program);
    }
    for plan in plans() {
        for program in programs_of(&plan) {
            let listing = format!("{}\n{}", program.entry, program.describe());
            all.entry(listing).or_insert(program);
        }
    }
    all
}
