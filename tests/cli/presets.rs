//! Presets are the text of a plan: what is written reads back to the last bit.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use conemarch::base::key::{Key, Kind};
use conemarch::plan::Plan;
use conemarch::preset::{
    BUILTIN, Override, Preset, PresetError, SECTIONS, builtin, keys, load, read, write,
};
use conemarch::scene::Scene;
use conemarch::scene::distance_settings::{DistanceSettings, MOST_ITERATIONS};
use conemarch::scene::slab::SlabSettings;
use proptest::prelude::*;
use toml::Value;

use super::page::reference;
use super::preset_errors::set_error;

/// A plan of every subject there is.
pub fn subjects() -> Vec<Plan> {
    Scene::all().into_iter().map(Plan::new).collect()
}

/// `[scene]` with nothing but what is required.
pub fn least(plan: &Plan) -> String {
    let (kind, formula) = (plan.scene.kind(), plan.scene.formula());
    let formula = formula.map_or(String::new(), |f| format!("formula = \"{f}\"\n"));
    format!("[scene]\nkind = \"{kind}\"\n{formula}")
}

/// Asks a key of a plan.
fn ask<T>(plan: &Plan, section: &str, name: &str, question: impl FnOnce(Key<'_>) -> T) -> T {
    let mut plan = plan.clone();
    let mut keys = plan.keys(section).expect("a section").into_iter();
    question(keys.find(|k| k.name == name).expect("a key"))
}

pub fn get(plan: &Plan, section: &str, name: &str) -> Value {
    ask(plan, section, name, |key| key.slot.get())
}

/// Every key of every section, with a plan of each subject.
pub fn all_keys() -> Vec<(Plan, &'static str, &'static str)> {
    let mut all = Vec::new();
    for plan in subjects() {
        for section in SECTIONS {
            let keys = plan
                .clone()
                .keys(section)
                .expect("a section")
                .into_iter()
                .map(|k| k.name)
                .collect::<Vec<_>>();
            all.extend(keys.into_iter().map(|name| (plan.clone(), section, name)));
        }
    }
    all
}

/// The text of a preset with nothing but what is required, and one line more.
pub fn with(plan: &Plan, section: &str, line: &str) -> String {
    match section {
        "scene" => format!("{}{line}\n", least(plan)),
        _ => format!("{}[{section}]\n{line}\n", least(plan)),
    }
}

pub fn toml(text: &str) -> Value {
    let table: toml::Table = format!("x = {text}").parse().expect("TOML");
    table["x"].clone()
}

#[test]
fn the_list_of_presets_is_the_folder() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/presets");
    let files = std::fs::read_dir(folder).expect("the folder");
    let name = |file: std::fs::DirEntry| {
        let name = file.file_name().into_string().expect("a name");
        name.strip_suffix(".toml").expect("a preset").to_string()
    };
    let mut files: Vec<String> = files.map(|f| name(f.expect("a file"))).collect();
    files.sort();
    let list: Vec<&str> = BUILTIN.iter().map(|(n, _)| *n).collect();
    assert_eq!(
        list, files,
        "src/preset/builtin.rs and presets/ differ, or are unsorted"
    );
}

/// Pictures have the details of 2160 rows at all smaller sizes. Presets for measurements refer to the
/// pixel.
#[test]
fn built_in_pictures_have_the_same_details_up_to_2160_rows() {
    for (name, _) in BUILTIN {
        let reference = load(name, &[]).expect("built in").plan.reference;
        let expected = (!name.starts_with("bench-")).then_some(2160);
        assert_eq!(reference, expected, "{name}");
    }
}

#[test]
fn no_built_in_preset_is_too_near_to_a_surface_for_f32() {
    for (name, _) in BUILTIN {
        let plan = load(name, &[]).expect("built in").plan;
        assert_eq!(plan.precision_warning(), None, "{name}");
    }
}

/// The eye is by the face of a Mandelbox at height 6. A pair of eyes sees it from one eye alone.
#[test]
fn only_what_is_seen_is_too_near_for_f32() {
    for (target, stereo, warns) in [
        ("[0, 0, 5]", "off", true),
        ("[0, 0, 7]", "off", false),
        ("[0, 0, 5]", "pair", true),
        ("[0, 0, 7]", "pair", false),
    ] {
        let text = format!(
            "[scene]\nkind = 'distance'\nformula = 'mandelbox'
            [camera]\neye = [0, 0, 6.001]\ntarget = {target}\nup = [0, 1, 0]\nfov = 40\nstereo = '{stereo}'"
        );
        let plan = read(&text, "near").expect("a preset");
        assert_eq!(plan.precision_warning().is_some(), warns, "{text}");
    }
}

#[test]
fn built_in_presets_are_right_and_have_a_title() {
    for (name, text) in BUILTIN {
        let plan = read(text, name).unwrap_or_else(|e| panic!("{e}"));
        assert!(!plan.title.is_empty(), "{name} has no title");
        assert_eq!(load(name, &[]).expect("the same").plan, plan);
    }
}

#[test]
fn bench_presets_are_the_agreed_ones() {
    let rows: [(&str, [f64; 3], [f64; 3], f64); 5] = [
        ("bench-far", [0.0, 0.0, -14.0], [0.0; 3], 2.0),
        ("bench-outside", [4.0, 2.5, -6.0], [0.0; 3], -1.5),
        ("bench-inside", [1.0, 0.4, -3.5], [0.2, 0.1, 0.0], -1.5),
        ("bench-graze", [6.5, 6.4, -7.5], [0.0, 5.5, 0.0], 2.0),
        ("bench-thin", [3.0, 3.0, -9.0], [0.0; 3], 3.0),
    ];
    for (name, eye, target, scale) in rows {
        let plan = load(name, &[]).expect(name).plan;
        assert_eq!(plan.camera.eye.to_array(), eye, "{name}");
        assert_eq!(plan.camera.target.to_array(), target, "{name}");
        assert_eq!(plan.camera.up.to_array(), [0.0, 1.0, 0.0], "{name}");
        assert_eq!(plan.camera.fov, 48.5, "{name}");
        assert_eq!(plan.size, [640, 360], "{name}");
        assert_eq!(get(&plan, "scene", "scale"), Value::Float(scale), "{name}");
    }
}

#[test]
fn every_plan_reads_back_from_its_text() {
    let built_in = BUILTIN.iter().map(|(n, t)| read(t, n).expect("right"));
    for plan in built_in.chain(subjects()) {
        let text = write(&plan);
        let again = read(&text, "written").unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(again, plan, "{text}");
        assert_eq!(write(&again), text);
    }
}

#[test]
fn only_kind_and_formula_are_required_and_the_rest_is_default() {
    for plan in subjects() {
        assert_eq!(read(&least(&plan), "least").expect("enough"), plan);
    }
}

/// All keys, with their help and words.
static KEYS: LazyLock<Vec<(String, &str, Vec<String>)>> = LazyLock::new(keys);

/// Values for keys that tell no range: each takes some of them.
const OTHER: &str = r#"0.5;1;1.5;2;16;"sine:8x8";"a line";[5, 7];[1, 2];[0.5];[0.5, 0.75]"#;

/// Values of a kind: all of few, else the ends of the range, and some between.
fn candidates(kind: &Kind) -> Vec<Value> {
    let between = |[low, high]: [f64; 2], share: f64| low + share * (high - low);
    let triple = |range, shares: [f64; 3]| Value::from(shares.map(|x| between(range, x)).to_vec());
    match kind {
        Kind::Number(range) => [0.0, 1e-3, 0.1, 0.3, 1.0]
            .map(|share| between(*range, share).into())
            .to_vec(),
        Kind::Count([low, high]) => [*low, low + 1, low.midpoint(*high), *high]
            .map(Value::from)
            .to_vec(),
        Kind::Switch => [true, false].map(Value::from).to_vec(),
        Kind::Word(words) => words.iter().map(|word| (*word).into()).collect(),
        Kind::Triple(range) => [[0.25, 0.5, 0.75], [1.0, 0.9, 0.2]]
            .map(|shares| triple(*range, shares))
            .to_vec(),
        Kind::Triples(most, range) => [1, *most]
            .map(|n| vec![triple(*range, [0.1, 0.2, 0.3]); n].into())
            .to_vec(),
        Kind::Auto(kind) => [vec!["auto".into()], candidates(kind)].concat(),
        Kind::Other => OTHER.split(';').map(toml).collect(),
    }
}

/// Settings of a key that it takes for itself, with its words first; not all fit the rest of a plan.
fn settings(plan: &Plan, section: &str, name: &str) -> Vec<String> {
    let path = format!("{section}.{name}");
    let (.., words) = KEYS.iter().find(|(key, ..)| *key == path).expect("a key");
    let told = words.iter().map(|word| word.as_str().into());
    let kind = ask(plan, section, name, |key| key.slot.kind());
    let all = told.chain(candidates(&kind));
    let fits = |value: &Value| ask(plan, section, name, |mut key| key.slot.set(value).is_ok());
    let fitting = all.filter(fits);
    fitting.map(|value| format!("{path}={value}")).collect()
}

/// The least preset of a plan's scene with settings.
fn set(plan: &Plan, settings: &[&str]) -> Result<Plan, PresetError> {
    let sets = settings.iter().map(|set| Override::read(set));
    let sets: Result<Vec<Override>, PresetError> = sets.collect();
    Ok(Preset::read(&least(plan), "least", &sets?)?.plan)
}

#[test]
fn every_key_can_be_set_in_a_file_and_by_override_and_reads_back() {
    let mut changing = BTreeSet::new();
    for (plan, section, name) in all_keys() {
        let path = format!("{section}.{name}");
        let before = get(&plan, section, name);
        let mut is_heard = false;
        for setting in settings(&plan, section, name) {
            let set = match set(&plan, &[&setting]) {
                Ok(set) => set,
                Err(e) => {
                    assert!(e.to_string().contains(&path), "{e}");
                    is_heard = true;
                    continue;
                }
            };
            let file = with(&plan, section, &setting[section.len() + 1..]);
            assert_eq!(read(&file, "file").expect(&file), set, "{file}");
            assert_eq!(read(&write(&set), "again").expect(&file), set);
            if get(&set, section, name) != before {
                changing.insert(path.clone());
                is_heard = true;
            }
        }
        assert!(is_heard, "no candidate for {path} does anything");
    }
    // Some keys need another one of their section first, and some another scene.
    for (plan, section, name) in all_keys() {
        if changing.contains(&format!("{section}.{name}")) {
            continue;
        }
        let others = all_keys()
            .into_iter()
            .filter(|(p, s, _)| (p, *s) == (&plan, section));
        let first = others.flat_map(|(plan, section, name)| settings(&plan, section, name));
        let own = settings(&plan, section, name);
        let before = get(&plan, section, name);
        let changes = |first: &String| {
            let both = own.iter().map(|own| set(&plan, &[first, own]));
            both.flatten().any(|set| get(&set, section, name) != before)
        };
        if first.collect::<Vec<_>>().iter().any(changes) {
            changing.insert(format!("{section}.{name}"));
        }
    }
    for (_, section, name) in all_keys() {
        let path = format!("{section}.{name}");
        assert!(changing.contains(&path), "no candidate changes {path}");
    }
}

#[test]
fn words_need_no_quotes_and_whole_numbers_are_floats() {
    let sets = [
        "march.mode=ray-relaxed",
        "camera.fov=30",
        "title=Two words, no quotes",
    ];
    let sets = sets.map(|s| Override::read(s).expect(s));
    let plan = load("mandelbox", &sets).expect("fits").plan;
    assert_eq!(plan.march.mode.name(), "ray-relaxed");
    assert_eq!(plan.camera.fov, 30.0);
    assert_eq!(plan.title, "Two words, no quotes");
}

#[test]
fn fields_and_paths_need_no_quotes() {
    let text = "[scene]\nkind = \"heightfield\"\n";
    // What becomes of a value, be it a plan or a sentence about a missing file.
    let set = |value: &str| {
        let set = Override::read(&format!("scene.field={value}"));
        let plan = set.and_then(|set| Ok(Preset::read(text, "p.toml", &[set])?.plan));
        plan.map_err(|e| e.to_string().replace('"', ""))
    };
    let bare = "fbm fbm:64x64,seed=3 ridges:12x7,power=1.5 d8.png true.png inf/nan.exr ./maps/rock-2_b.png ../a+b.exr /tmp/x.raw 2k.exr 8k/sky.hdr 1979-05-27.png a#1.png";
    for word in bare.split(' ') {
        assert_eq!(set(word), set(&format!("\"{word}\"")));
    }
    for word in ["-inf.png", "a b.png", "~/a.png", "fbm:4x4;"] {
        let why = set(word).expect_err(word);
        assert!(why.contains("the value is not TOML"), "{why}");
    }
    // What is a value of its own stays one.
    for value in ["inf", "nan", "true", "false", "-inf", "30"] {
        let e = set_error(&[&format!("title={value}")]);
        assert!(e.contains("must be a line of text"), "{e}");
    }
    for value in ["inf", "nan"] {
        let e = set_error(&[&format!("camera.fov={value}")]);
        assert!(e.contains("must be a number"), "{e}");
    }
    let set = Override::read("scene.julia=true").expect("a value");
    let plan = load("mandelbox", &[set]).expect("a switch").plan;
    assert_eq!(get(&plan, "scene", "julia"), Value::Boolean(true));
}

#[test]
fn another_formula_starts_from_its_own_defaults() {
    let set = Override::read("scene.formula=balls").expect("a value");
    let plan = load("mandelbox", &[set]).expect("scale is dropped").plan;
    assert_eq!(
        (plan.scene.kind(), plan.scene.formula()),
        ("distance", Some("balls"))
    );
    let same = Override::read("scene.formula=mandelbox").expect("a value");
    let plan = load("bench-thin", &[same]).expect("no change").plan;
    assert_eq!(get(&plan, "scene", "scale"), Value::Float(3.0));
    let set = Override::read("scene.kind=slab").expect("a value");
    let plan = load("mandelbox", &[set]).expect("all is dropped").plan;
    assert_eq!(plan.scene, Scene::Slab(SlabSettings::default()));
}

proptest! {
    #[test]
    fn any_text_is_a_plan_or_a_sentence(text in "\\PC{0,200}") {
        if let Err(e) = read(&text, "p.toml") {
            prop_assert!(!e.to_string().contains('\n'), "{e}");
        }
    }

    #[test]
    fn any_mangled_preset_is_a_plan_or_a_sentence(at in 0usize..600, junk in "[\\x00-\\x7f]{0,5}") {
        let text = builtin("mandelbox").expect("built in");
        let at = at.min(text.len());
        let mangled = format!("{}{junk}{}", &text[..at], &text[(at + 3).min(text.len())..]);
        if let Err(e) = read(&mangled, "p.toml") {
            prop_assert!(!e.to_string().contains('\n'), "{e}");
        }
    }

    #[test]
    fn any_override_is_a_value_or_a_sentence(text in "(scene|camera|title|[a-z.]{0,9})\\PC{0,40}") {
        if let Ok(set) = Override::read(&text) {
            let _ = load("mandelbox", &[set]);
        }
    }

    #[test]
    fn numbers_and_titles_read_back_to_the_last_bit(
        fov in 1.0f64..170.0,
        eye in prop::array::uniform3(-1e9f64..1e9),
        exposure in -20.0f64..20.0,
        title in "\\PC{0,40}",
        iterations in prop::option::of(1u32..1000),
    ) {
        let mut plan = load("mandelbox", &[]).expect("built in").plan;
        plan.camera.fov = fov;
        plan.camera.eye = eye.into();
        plan.look.exposure = exposure;
        plan.title = title;
        if let Scene::Distance(DistanceSettings { iterations: slot, .. }) = &mut plan.scene {
            *slot = iterations;
        }
        let again = read(&write(&plan), "written");
        prop_assert_eq!(again.map_err(|e| e.to_string()), Ok(plan));
    }
}

#[test]
fn the_page_is_what_would_be_written() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/presets.md");
    let text = std::fs::read_to_string(page).expect("the page");
    assert!(
        text == reference(),
        "{page} is out of date; `cargo bench --bench pages -- presets` writes it"
    );
}

#[test]
fn the_limit_of_automatic_iterations_is_told() {
    let help = format!("needs, up to {MOST_ITERATIONS} |");
    assert!(reference().contains(&help), "{help}");
}
