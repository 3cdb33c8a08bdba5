//! Presets are the text of a Plan: what is written reads back to the last bit, and what
//! is wrong is named with its place.

use conemarch::plan::Plan;
use conemarch::preset::{BUILTIN, Override, PresetError, builtin, load, read, read_with, write};
use conemarch::scene::Scene;
use conemarch::scene::distance::DistanceSettings;
use conemarch::scene::slab::SlabSettings;
use proptest::prelude::*;
use toml::Value;

const SECTIONS: [&str; 5] = ["scene", "camera", "march", "look", "image"];

/// A plan of every subject there is.
fn subjects() -> Vec<Plan> {
    Scene::all().into_iter().map(Plan::new).collect()
}

/// `[scene]` with nothing but what is required.
fn least(plan: &Plan) -> String {
    let (kind, formula) = (plan.scene.kind(), plan.scene.formula());
    let formula = formula.map_or(String::new(), |f| format!("formula = \"{f}\"\n"));
    format!("[scene]\nkind = \"{kind}\"\n{formula}")
}

fn names(plan: &Plan, section: &str) -> Vec<&'static str> {
    let mut plan = plan.clone();
    let keys = plan.keys(section).expect("a section");
    keys.iter().map(|k| k.name).collect()
}

fn get(plan: &Plan, section: &str, name: &str) -> Value {
    let mut plan = plan.clone();
    let keys = plan.keys(section).expect("a section");
    let key = keys.into_iter().find(|k| k.name == name).expect("a key");
    key.slot.get()
}

/// Whether a key takes a value, asked of the key itself.
fn takes(plan: &Plan, section: &str, name: &str, value: &Value) -> bool {
    let mut plan = plan.clone();
    let keys = plan.keys(section).expect("a section");
    let mut key = keys.into_iter().find(|k| k.name == name).expect("a key");
    key.slot.set(value).is_ok()
}

fn toml(text: &str) -> Value {
    let table: toml::Table = format!("x = {text}").parse().expect("TOML");
    table["x"].clone()
}

#[test]
fn the_list_of_presets_is_the_folder() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/presets");
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .expect("the folder")
        .map(|f| {
            let name = f.expect("a file").file_name();
            let name = name.into_string().expect("a name");
            name.strip_suffix(".toml").expect("a preset").to_string()
        })
        .collect();
    files.sort();
    let list: Vec<String> = BUILTIN.iter().map(|(n, _)| (*n).to_string()).collect();
    assert_eq!(
        list, files,
        "src/preset/builtin.rs and presets/ differ, or are unsorted"
    );
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

/// Values of many kinds; each key takes some of them.
const CANDIDATES: &[&str] = &[
    "0",
    "1",
    "2",
    "3",
    "17",
    "100",
    "0.5",
    "0.25",
    "1.5",
    "-1.5",
    "1e-3",
    "0.1",
    "true",
    "false",
    "\"auto\"",
    "\"off\"",
    "\"ray\"",
    "\"truth\"",
    "\"classic\"",
    "\"sine:8x8\"",
    "\"xy\"",
    "\"boxes\"",
    "\"csm-loop\"",
    "\"nearest\"",
    "\"walk\"",
    "[0.25, 0.5, 0.75]",
    "[1, 2, 3]",
    "[5, 7]",
    "[0.5]",
    "[0.5, 0.75]",
    "[[0.1, 0.2, 0.3]]",
    "[[0, 0, 0], [1, 1, 1]]",
];

#[test]
fn every_key_can_be_set_in_a_file_and_by_override_and_reads_back() {
    for plan in subjects() {
        for section in SECTIONS {
            for name in names(&plan, section) {
                let before = get(&plan, section, name);
                let mut changed = 0;
                for text in CANDIDATES {
                    if !takes(&plan, section, name, &toml(text)) {
                        continue;
                    }
                    let set = Override::read(&format!("{section}.{name}={text}"));
                    let set = set.unwrap_or_else(|e| panic!("{e}"));
                    // Some values fit the key, but not the rest of the plan.
                    let Ok(by_set) = read_with(&least(&plan), "least", &[set]) else {
                        continue;
                    };
                    let head = match section {
                        "scene" => "",
                        other => &format!("[{other}]\n"),
                    };
                    let file = format!("{}{head}{name} = {text}\n", least(&plan));
                    assert_eq!(read(&file, "file").expect(&file), by_set, "{file}");
                    assert_eq!(read(&write(&by_set), "again").expect(&file), by_set);
                    changed += usize::from(get(&by_set, section, name) != before);
                }
                // More than one tile needs axes that wrap, a texture a file: see the
                // heightfields below.
                assert!(
                    changed > 0 || ["tiles", "texture"].contains(&name),
                    "no candidate changes {section}.{name}"
                );
            }
        }
    }
}

#[test]
fn no_key_takes_what_is_no_value_for_anything_and_says_where() {
    let bad = [
        "nan",
        "inf",
        "-inf",
        "{}",
        "[]",
        "1979-05-27",
        "\"?\"",
        "[nan, 0, 0]",
        "1e400",
    ];
    for plan in subjects() {
        for section in SECTIONS {
            for name in names(&plan, section) {
                for text in bad {
                    let head = match section {
                        "scene" => "",
                        other => &format!("\n[{other}]\n"),
                    };
                    let file = format!("{}{head}{name} = {text}\n", least(&plan));
                    let line = file.lines().count();
                    let e = read(&file, "bad.toml").expect_err(&file);
                    let e = e.to_string();
                    let place = format!("bad.toml:{line}: ");
                    assert!(e.starts_with(&place), "{e}");
                    // Numbers that TOML has no room for are the parser's to refuse, and
                    // files of heights, cones and colours are looked for.
                    let named = ["field", "map", "texture"].contains(&name) && text == "\"?\"";
                    if text != "1e400" && !named {
                        let what = format!("bad.toml:{line}: {section}.{name} = {text}: must be ");
                        assert!(e.starts_with(&what), "{e}");
                    }
                    let set = Override::read(&format!("{section}.{name}={text}"));
                    let e = set
                        .and_then(|set| read_with(&least(&plan), "good.toml", &[set]))
                        .expect_err(&file);
                    assert!(e.is_usage(), "{e}");
                    let what = format!("--set {section}.{name}={text}: ");
                    assert!(e.to_string().starts_with(&what), "{e}");
                }
            }
        }
    }
}

/// What a preset's error says.
fn error(text: &str) -> String {
    let e = read(text, "p.toml").expect_err(text);
    assert!(
        !e.is_usage(),
        "a file's fault is not the command line's: {e}"
    );
    e.to_string()
}

#[test]
fn errors_name_line_key_value_and_what_would_do() {
    let slab = "[scene]\nkind = \"slab\"\n";
    let cases = [
        ("", "p.toml: scene.kind is missing"),
        (
            "[scene]\nkind = \"distance\"\n",
            "p.toml: scene.formula is missing; it is one of \"mandelbox\"",
        ),
        (
            "[scene]\nkind = \"distanc\"\n",
            "p.toml:2: scene.kind = \"distanc\": must be one of \"distance\", \"heightfield\", \"slab\", perhaps \"distance\"",
        ),
        (
            "[scene]\nkind = \"distance\"\nformula = \"mandelbx\"\n",
            "p.toml:3: scene.formula = \"mandelbx\": must be one of",
        ),
        (
            "[scene]\nkind = \"slab\"\nkind = \"slab\"\n",
            "p.toml:3: this is not TOML: duplicate key",
        ),
        ("[scene\n", "p.toml:1: this is not TOML: "),
        (
            &format!("{slab}\n[camera]\nfov = 400\n"),
            "p.toml:5: camera.fov = 400: must be a number from 1 to 170",
        ),
        (
            &format!("{slab}[camera]\nfow = 40\n"),
            "p.toml:4: camera.fow = 40: unknown key, perhaps `fov`; [camera] has eye, target, up, fov",
        ),
        (
            &format!("{slab}[camer]\nfov = 40\n"),
            "p.toml:3: unknown section `camer`, perhaps `camera`",
        ),
        (
            &format!("{slab}half = [\n0.5\n]\n"),
            "p.toml:3: scene.half = [ 0.5 ]: must be a number from",
        ),
        (
            &format!("camera = 3\n{slab}"),
            "p.toml:1: camera = 3: must be a section, like [camera]",
        ),
        (
            &format!("title = 3\n{slab}"),
            "p.toml:1: title = 3: must be a line of text",
        ),
        (
            &format!("{slab}[image]\nsize = [0, 5]\n"),
            "p.toml:4: image.size = [0, 5]: must be [width, height] in pixels",
        ),
        (
            &format!("{slab}[image]\nsize = [5, 99999999999999999999]\n"),
            "p.toml:4: image.size = ",
        ),
        (
            &format!("{slab}[camera]\neye = [1, 2, 3]\ntarget = [1, 2, 3]\n"),
            "p.toml:5: camera.target = [1, 2, 3]: the eye and the target are the same point",
        ),
        (
            &format!("{slab}[camera]\neye = [0, 0, 0]\n"),
            "p.toml: camera.target = [0.0, 0.0, 0.0] (the default): the eye and the target",
        ),
        (
            &format!("{slab}[camera]\neye = [0, 0, 5]\n"),
            "p.toml: camera.up = [0.0, 0.0, 1.0] (the default): up must not be",
        ),
        (
            &format!("{slab}[march]\ncoarsest = 3\n"),
            "p.toml:4: march.coarsest = 3: must be a power of two",
        ),
        (
            "[scene]\nkind = \"slab\"\nformula = \"mandelbox\"\n",
            "p.toml:3: scene.formula = \"mandelbox\": a slab has no formula",
        ),
        (
            "[scene]\nkind = \"distance\"\nformula = \"mandelbox\"\nscale = 0.5\n",
            "p.toml:4: scene.scale = 0.5: ",
        ),
    ];
    for (text, says) in cases {
        let e = error(text);
        assert!(e.starts_with(says), "{e}\n  should begin with\n{says}");
        assert!(!e.contains('\n'), "one sentence: {e}");
    }
}

#[test]
fn heightfields_say_what_does_not_fit() {
    let of = |rest: &str| format!("[scene]\nkind = \"heightfield\"\n{rest}\n");
    let path = "docs/stones.png";
    let textured = of(&format!("texture = \"{path}\""));
    let plan = read(&textured, "p.toml").expect("a picture");
    assert_eq!(get(&plan, "scene", "texture"), Value::String(path.into()));
    assert_eq!(read(&write(&plan), "again").expect("a picture"), plan);
    let tiled = of("field = \"sine:8x8\"\nwrap = \"xy\"\ntiles = [5, 7]");
    let plan = read(&tiled, "p.toml").expect("tiles of what wraps");
    assert_eq!(get(&plan, "scene", "tiles"), toml("[5, 7]"));
    assert_eq!(read(&write(&plan), "again").expect("its own text"), plan);
    for (rest, says) in [
        (
            "tiles = [1, 2]",
            "p.toml:3: scene.tiles = [1, 2]: the map is repeated along y, where it does not wrap",
        ),
        (
            "field = \"fbm:9000x1\"",
            "p.toml:3: scene.field = \"fbm:9000x1\": `9000x1` is no size",
        ),
        (
            "field = \"hills\"",
            "p.toml:3: scene.field = \"hills\": hills: there is no such file or field; fields are fbm",
        ),
        (
            "field = \"none/there.png\"",
            "p.toml:3: scene.field = \"none/there.png\": none/there.png: ",
        ),
        (
            "map = \"exact\"",
            "p.toml:3: scene.map = \"exact\": the tracer walk cannot use such cones; it can those of walk",
        ),
        (
            "tracer = \"max-mip\"\nmap = \"exact\"",
            "p.toml:4: scene.map = \"exact\": the tracer max-mip needs no cones",
        ),
        (
            "tracer = \"linear-binary\"\nmap = \"none/there.exr\"",
            "p.toml:4: scene.map = \"none/there.exr\": the tracer linear-binary needs no cones",
        ),
        (
            "map = \"none/there.exr\"",
            "p.toml:3: scene.map = \"none/there.exr\": none/there.exr: ",
        ),
        (
            "field = \"fbm:8192x8192\"\nwrap = \"xy\"\ntiles = [256, 256]",
            "p.toml:5: scene.tiles = [256, 256]: 256 tiles of 8192 cells along axis 0: one tile or more, and 65536 cells at most",
        ),
        (
            "field = \"fbm:4x1024\"\nwrap = \"y\"\ntiles = [1, 65]",
            "p.toml:5: scene.tiles = [1, 65]: 65 tiles of 1024 cells along axis 1: ",
        ),
    ] {
        let e = error(&of(rest));
        assert!(e.starts_with(says), "{e}\n  should begin with\n{says}");
    }
    let most = of("field = \"fbm:8192x1024\"\nwrap = \"xy\"\ntiles = [8, 64]");
    read(&most, "p.toml").expect("as many cells as there may be");
    let tiled = of("field = \"fbm:1024x1024\"\nwrap = \"xy\"");
    let set = Override::read("scene.tiles=[65, 64]").expect("a value");
    let e = read_with(&tiled, "p.toml", &[set]).expect_err("too many");
    let says = "--set scene.tiles=[65, 64]: 65 tiles of 1024 cells along axis 0: ";
    assert!(e.is_usage() && e.to_string().starts_with(says), "{e}");
}

/// What an override's error says.
fn set_error(sets: &[&str]) -> String {
    let text =
        "[scene]\nkind = \"distance\"\nformula = \"mandelbox\"\n[camera]\ntarget = [0, 0, 0]\n";
    let sets: Result<Vec<_>, _> = sets.iter().map(|s| Override::read(s)).collect();
    let e = sets.and_then(|s| read_with(text, "p.toml", &s).map(|_| ()));
    let e = e.expect_err("should be refused");
    assert!(e.is_usage(), "{e}");
    e.to_string()
}

#[test]
fn errors_of_overrides_name_the_override() {
    let cases: [(&[&str], &str); 13] = [
        (&["camera.fov"], "--set camera.fov: there is no `=`"),
        (&["fov=3"], "--set fov=3: `fov` names no section"),
        (&["=3"], "--set =3: `` names no section"),
        (&[".scale=3"], "--set .scale=3: `.scale` names no section"),
        (&[".=3"], "--set .=3: `.` names no section"),
        (&["cam.fov=3"], "--set cam.fov=3: unknown section `cam`"),
        (
            &["camera.fow=3"],
            "--set camera.fow=3: unknown key, perhaps `fov`",
        ),
        (
            &["camera.fov=[1"],
            "--set camera.fov=[1: the value is not TOML",
        ),
        (
            &["camera.eye=[0, 0, 0]"],
            "--set camera.eye=[0, 0, 0]: p.toml:5: camera.target = [0, 0, 0]: the eye",
        ),
        // Both are checked, though the second overrides the first.
        (
            &["camera.fov=0", "camera.fov=50"],
            "--set camera.fov=0: must be",
        ),
        (&["scene.scale=0.5"], "--set scene.scale=0.5: "),
        (
            &["scene.kind=cube", "scene.kind=distance"],
            "--set scene.kind=cube: must be one of",
        ),
        (
            &["scene.formula=cube", "scene.formula=balls"],
            "--set scene.formula=cube: must be one of",
        ),
    ];
    for (sets, says) in cases {
        let e = set_error(sets);
        assert!(e.starts_with(says), "{e}\n  should begin with\n{says}");
    }
}

#[test]
fn a_preset_must_be_right_without_its_overrides() {
    let text = "[scene]\nkind = \"slab\"\n[camera]\nfov = 400\n";
    let set = Override::read("camera.fov=40").expect("a value");
    let e = read_with(text, "p.toml", &[set]).expect_err("400 is wrong all the same");
    assert!(
        matches!(e, PresetError::Content { line: Some(4), .. }),
        "{e}"
    );
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
        let plan = set.and_then(|set| read_with(text, "p.toml", &[set]));
        plan.map_err(|e| e.to_string().replace('"', ""))
    };
    for word in [
        "fbm",
        "fbm:64x64,seed=3",
        "ridges:12x7,power=1.5",
        "d8.png",
        "true.png",
        "inf/nan.exr",
        "./maps/rock-2_b.png",
        "../a+b.exr",
        "/tmp/x.raw",
    ] {
        assert_eq!(set(word), set(&format!("\"{word}\"")));
    }
    for word in [
        "1979-05-27.png",
        "-inf.png",
        "a b.png",
        "~/a.png",
        "fbm:4x4;",
    ] {
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
