//! Every program that can be made: of presets, of scenes with each key moved, in all modes,
//! with and without each feature of the look, and of the generators of cone maps.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use conemarch::base::shader::{Program, ShaderError};
use conemarch::formula::Formula;
use conemarch::heightfield::conemap::generate;
use conemarch::plan::march::MODES;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::BUILTIN;
use rayon::prelude::*;
use toml::Value;
use wgpu::naga::{self, valid::Capabilities};

use super::common::plans::{Scene, distance, passes, preset, program, solid};

/// A feature of the look: its switch, and its file with that of the stand-in.
pub struct Feature {
    /// Switches it on or off.
    pub set: fn(&mut Plan, bool),
    /// The name of its file; the stand-in's ends in `_off`.
    pub name: &'static str,
}

/// All features of the look.
pub const FEATURES: [Feature; 3] = [
    Feature {
        set: |p, on| p.look.shadow = on,
        name: "shadow",
    },
    Feature {
        set: |p, on| p.look.occlusion = f64::from(u8::from(on)),
        name: "occlusion",
    },
    Feature {
        set: |p, on| p.look.fog = f64::from(u8::from(on)),
        name: "fog",
    },
];

/// All values worth trying for a key: the other state of a switch, every word of a list of
/// words, and a triple away from zero.
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

/// Adds the scene once more for each value of each of its keys that could choose a feature.
fn add_each_key_moved(scene: &Scene, all: &mut Vec<Scene>) {
    for index in 0..scene.clone().keys().len() {
        let tried = {
            let mut copy = scene.clone();
            let key = &copy.keys()[index];
            values(&key.slot.get(), &key.slot.expects())
        };
        for value in tried {
            let mut moved = scene.clone();
            let fits = moved.keys()[index].slot.set(&value).is_ok();
            if fits && !all.contains(&moved) {
                all.push(moved);
            }
        }
    }
}

/// Every kind of scene and every formula, with its features: of a formula up to three at a
/// time, of a heightfield, which has many tracers, one.
fn scenes() -> Vec<Scene> {
    let mut all = Vec::new();
    for mut scene in Scene::all() {
        let mut times = 3;
        // Small: what is joined does not depend on how many samples there are.
        if let Scene::Heightfield(settings) = &mut scene {
            settings.source.field = "fbm:16x16".into();
            times = 1;
        }
        let mut moved = vec![scene];
        for _ in 0..times {
            for one in moved.clone() {
                add_each_key_moved(&one, &mut moved);
            }
        }
        all.extend(moved);
    }
    // Few iterations and many: what could overflow is guarded.
    for formula in Formula::all() {
        let limits = [2, 1000].into_iter();
        all.extend(limits.map(|most| distance(formula.clone(), Some(most))));
    }
    all
}

/// All plans: presets and scenes, in every mode and with every feature of the look. The
/// modes and the looks of a heightfield are tried apart.
fn plans() -> Vec<Plan> {
    let presets = BUILTIN.iter().map(|(name, _)| preset(name, &[]));
    let first = presets.chain(scenes().into_iter().map(Plan::new));
    let mut all = Vec::new();
    for plan in first {
        for (_, mode) in MODES {
            for look in 0..1 << FEATURES.len() {
                let apart = matches!(plan.subject, Scene::Heightfield(_));
                if apart && look > 0 && *mode != plan.march.mode {
                    continue;
                }
                let mut one = plan.clone();
                one.march.mode = *mode;
                for (at, feature) in FEATURES.iter().enumerate() {
                    (feature.set)(&mut one, look & (1 << at) > 0);
                }
                all.push(one);
            }
        }
    }
    all
}

/// All different programs of a plan's passes, with work counted or not and normals kept or
/// not.
pub fn programs_of(plan: &Plan) -> Vec<Program> {
    let solid = solid(plan);
    let mut all: Vec<Program> = Vec::new();
    for pass in passes(plan, Extras::default()) {
        for bits in 0..4 {
            let extras = Extras {
                count: bits & 1 > 0,
                normals: bits & 2 > 0,
                ..Extras::default()
            };
            let program = program(plan, &solid, pass, extras);
            if !all.contains(&program) {
                all.push(program);
            }
        }
    }
    all
}

/// A program, and what validation in f32 makes of it.
pub struct Checked {
    /// The program.
    pub program: Program,
    /// Its naga module, or its fault.
    pub module: Result<naga::Module, ShaderError>,
}

/// All different programs by entry and listing.
pub static ALL: LazyLock<BTreeMap<String, Checked>> = LazyLock::new(|| {
    let mut found = BTreeMap::new();
    let of_plans = plans().into_iter().flat_map(|plan| programs_of(&plan));
    for program in generate::program::every_program()
        .into_iter()
        .chain(of_plans)
    {
        let listing = format!("{}\n{}", program.entry, program.describe());
        found.entry(listing).or_insert(program);
    }
    let checked = |(listing, program): (String, Program)| {
        let valid = program.validate(Capabilities::default());
        let module = valid.map(|(module, _)| module);
        (listing, Checked { program, module })
    };
    found.into_par_iter().map(checked).collect()
});
