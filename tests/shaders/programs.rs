//! Every program that can be made: of presets, of scenes with each key moved, in all modes,
//! with and without each feature of the look, and of the generators of cone maps.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use conemarch::base::projection::Projection;
use conemarch::base::shader::Program;
use conemarch::formula::Formula;
use conemarch::pass::LookFeature;
use conemarch::pass::pick;
use conemarch::pass::turn::{self, StageKind};
use conemarch::plan::layers::Trap;
use conemarch::plan::look::LightMode;
use conemarch::plan::march::Mode;
use conemarch::plan::{Background, Extras, Plan};
use conemarch::preset::BUILTIN;
use conemarch::scene::{AnySolid, Assets, Scene};
use rayon::prelude::*;
use toml::Value;
use wgpu::naga::{self, AddressSpace, valid::Capabilities};

use super::common::plans::{
    allow, distance, outline, preset, program, solid, switch, switch_all_off,
};
use super::common::programs::map_programs;

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

/// The plan with no feature of the look, each alone and with what it needs, all, and all without each.
fn looks(plan: &Plan) -> Vec<Plan> {
    let (mut none, mut full) = (plan.clone(), plan.clone());
    switch_all_off(&mut none);
    for feature in LookFeature::ALL {
        switch(&mut full, *feature, true);
    }
    let mut all = vec![none.clone(), full.clone()];
    for feature in LookFeature::ALL {
        let [mut alone, mut without] = [none.clone(), full.clone()];
        switch(&mut alone, *feature, true);
        switch(&mut without, *feature, false);
        let mut with = alone.clone();
        allow(&mut with, *feature);
        all.extend([alone, with, without]);
    }
    all
}

/// All plans: presets and scenes, in every mode, and with each feature of the look. Modes and looks
/// are tried apart.
fn plans() -> Vec<Plan> {
    let presets = BUILTIN.iter().map(|(name, _)| preset(name, &[]));
    let projected = Projection::WORDS.iter().map(|(_, projection)| {
        let mut plan = preset("mandelbox", &[]);
        plan.camera.projection = *projection;
        plan
    });
    let mut lens = preset("mandelbox", &[]);
    lens.camera.aperture = 0.1;
    lens.samples = 2;
    let scenes = scenes().into_iter().map(Plan::new);
    let first = presets.chain(projected).chain([lens]).chain(scenes);
    let mut all = Vec::new();
    for plan in first {
        let looks = looks(&plan);
        for mode in &Mode::ALL {
            let mut one = looks[0].clone();
            one.march.mode = *mode;
            all.push(one);
        }
        for mode in LightMode::ALL {
            for look in &looks {
                let mut one = look.clone();
                one.look.mode = mode;
                let mut under = one.clone();
                under.look.sky.sky_file = "sky.hdr".into();
                all.extend([one, under]);
            }
        }
    }
    let mut clear = preset("mandelbox", &[]);
    clear.background = Background::Transparent;
    all.push(clear);
    for formula in Formula::all() {
        let mut layered = Plan::new(distance(formula, None));
        layered.look.layers.layer2_trap = Trap::Point;
        all.push(layered);
    }
    all
}

/// All different programs of a plan's passes, with work counted or not and normals kept or
/// not.
pub fn programs_of(plan: &Plan, solid: &AnySolid) -> Vec<Program> {
    let mut all: Vec<Program> = Vec::new();
    for pass in plan.passes(Extras::default()) {
        for [count, normals] in [[false; 2], [true, false], [false, true], [true; 2]] {
            let extras = Extras {
                count,
                normals,
                ..Extras::default()
            };
            let program = program(plan, solid, pass, extras);
            if !all.contains(&program) {
                all.push(program);
            }
        }
    }
    all
}

/// The programs between the passes.
fn between_passes() -> Vec<Program> {
    let mut plan = preset("mandelbox", &[]);
    (plan.samples, plan.until) = (16, 0.01);
    let mut clear = plan.clone();
    clear.background = Background::Transparent;
    let solid = solid(&plan);
    let kinds = StageKind::all(&plan.passes(Extras::default()), [true; 3]).into_iter();
    let between = kinds.filter(|kind| !matches!(kind, StageKind::Pass(_)));
    let programs = between.flat_map(|kind| {
        let plans = [&plan, &clear].into_iter();
        plans.map(move |plan| (plan, kind))
    });
    let programs = programs.map(|(plan, kind)| kind.program(plan, &solid, Extras::default()));
    programs.chain([turn::arrange()]).collect()
}

/// A valid program.
pub struct Made {
    /// The program.
    pub program: Program,
    /// What naga makes of it.
    pub module: naga::Module,
    /// How many storage buffers its entry point reaches. It need not reach all that its modules
    /// declare.
    pub buffers: usize,
}

impl Made {
    pub fn new(program: Program) -> Self {
        let valid = program.validate(Capabilities::default());
        let (module, info) = valid.unwrap_or_else(|e| panic!("{e}\n{}", program.describe()));
        let entry = info.get_entry_point(0);
        let reached = module.global_variables.iter().filter(|(handle, v)| {
            matches!(v.space, AddressSpace::Storage { .. }) && !entry[*handle].is_empty()
        });
        let buffers = reached.count();
        Self {
            program,
            module,
            buffers,
        }
    }
}

/// All different programs by entry and listing.
///
/// # Panics
/// When one is not valid in f32 with exactly its constants.
pub static ALL: LazyLock<BTreeMap<String, Made>> = LazyLock::new(|| {
    let mut found = BTreeMap::new();
    let assets = Assets::default();
    let plans = plans().into_iter();
    let of_plans = plans.flat_map(|plan| {
        let solid = outline(&plan, &assets);
        let passes = programs_of(&plan, &solid).into_iter();
        passes.chain([pick::program(&plan.view(), &solid)])
    });
    for program in map_programs()
        .into_iter()
        .chain(of_plans)
        .chain(between_passes())
    {
        let listing = format!("{}\n{}", program.entry, program.describe());
        found.entry(listing).or_insert(program);
    }
    let made = found.into_par_iter();
    made.map(|(listing, program)| (listing, Made::new(program)))
        .collect()
});
