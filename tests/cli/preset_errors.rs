//! Errors of presets and overrides: the place, the key, the value, and what to write instead.

use conemarch::plan::Plan;
use conemarch::preset::{Override, Preset, PresetError, write};
use conemarch::scene::Assets;
use toml::Value;

use super::presets::{all_keys, get, least, toml, with};

/// Reads a preset with overrides, and the files that it names.
fn read_with(text: &str, origin: &str, sets: &[Override]) -> Result<Plan, PresetError> {
    let preset = Preset::read(text, origin, sets)?;
    preset.load_assets(&Assets::default())?;
    Ok(preset.plan)
}

fn read(text: &str, origin: &str) -> Result<Plan, PresetError> {
    read_with(text, origin, &[])
}

#[test]
fn no_key_takes_what_is_no_value_for_anything_and_says_where() {
    let bad = r#"nan;inf;-inf;{};[];1979-05-27;"?";[nan, 0, 0];1e400"#;
    for (plan, section, name) in all_keys() {
        for text in bad.split(';') {
            let file = with(&plan, section, &format!("{name} = {text}"));
            let line = file.lines().count();
            let e = read(&file, "bad.toml").expect_err(&file).to_string();
            assert!(e.starts_with(&format!("bad.toml:{line}: ")), "{e}");
            // The parser itself rejects numbers that are too large, and files of heights,
            // cones, colours and skies are looked for.
            let named = ["field", "map", "texture", "sky_file"].contains(&name) && text == "\"?\"";
            if text != "1e400" && !named {
                let what = format!("bad.toml:{line}: {section}.{name} = {text}: must be ");
                assert!(e.starts_with(&what), "{e}");
            }
            let set = Override::read(&format!("{section}.{name}={text}"));
            let e = set.and_then(|set| read_with(&least(&plan), "good.toml", &[set]));
            let e = e.expect_err(&file);
            assert!(e.is_usage(), "{e}");
            let what = format!("--set {section}.{name}={text}: ");
            assert!(e.to_string().starts_with(&what), "{e}");
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

/// A preset, with `|` for the ends of lines, and how its error begins.
const ERRORS: &str = r#"
 => p.toml: scene.kind is missing; it is one of "distance", "heightfield", "slab"
[scene]|kind = "distance" => p.toml: scene.formula is missing; it is one of "mandelbox"
[scene]|kind = "distanc" => p.toml:2: scene.kind = "distanc": must be one of "distance", "heightfield", "slab", perhaps "distance"
[scene]|kind = "distance"|formula = "mandelbx" => p.toml:3: scene.formula = "mandelbx": must be one of
[scene]|kind = "slab"|kind = "slab" => p.toml:3: this is not TOML: duplicate key
[scene => p.toml:1: this is not TOML:
[scene]|kind = "slab"||[camera]|fov = 400 => p.toml:5: camera.fov = 400: must be a number from 1 to 360
[scene]|kind = "slab"|[camera]|Fow = 40 => p.toml:4: camera.Fow = 40: unknown key, perhaps `fov`; [camera] has eye, target, up, fov
[scene]|kind = "slab"|[camer]|fov = 40 => p.toml:3: unknown section `camer`, perhaps `camera`
[scene]|kind = "slab"|half = [|0.5|] => p.toml:3: scene.half = [ 0.5 ]: must be a number from
camera = 3|[scene]|kind = "slab" => p.toml:1: camera = 3: must be a section, like [camera]
title = 3|[scene]|kind = "slab" => p.toml:1: title = 3: must be a line of text
[scene]|kind = "slab"|[image]|size = [0, 5] => p.toml:4: image.size = [0, 5]: must be [width, height] in pixels
[scene]|kind = "slab"|[image]|size = [5, 99999999999999999999] => p.toml:4: image.size =
[scene]|kind = "slab"|[camera]|eye = [1, 2, 3]|target = [1, 2, 3] => p.toml:5: camera.target = [1, 2, 3]: the eye and the target are the same point
[scene]|kind = "slab"|[camera]|eye = [0, 0, 0] => p.toml: camera.target = [0.0, 0.0, 0.0] (the default): the eye and the target
[scene]|kind = "slab"|[camera]|eye = [0, 0, 5] => p.toml: camera.up = [0.0, 0.0, 1.0] (the default): up must not be
[scene]|kind = "slab"|[march]|coarsest = 3 => p.toml:4: march.coarsest = 3: must be "auto" or a power of two
[scene]|kind = "slab"|[march]|mode = "calibrated"|coarsest = 8|fudge = [1, 1, 1, 1] => p.toml:6: march.fudge = [1, 1, 1, 1]: 4 factors for 3 cone passes; give at most 3
[scene]|kind = "slab"|formula = "mandelbox" => p.toml:3: scene.formula = "mandelbox": a slab has no formula
[scene]|kind = "distance"|formula = "mandelbox"|scale = 0.5 => p.toml:4: scene.scale = 0.5:
[scene]|kind = "distance"|formula = "mandelbox"|estimate = "classic"|[march]|mode = "proven" => p.toml:6: march.mode = "proven": there is a proof only for scene.estimate = "tight"
track = 3|[scene]|kind = "slab" => p.toml:1: a track is written [[track]]
[scene]|kind = "slab"|[[track]]|keys = [[0, 1]] => p.toml:3: a track has key = "section.key", keys = [[time, value], ...]
[scene]|kind = "slab"|[[track]]|key = "camera.fov" => p.toml:3: a track has key = "section.key", keys = [[time, value], ...]
[scene]|kind = "slab"|[[track]]|key = "camera.fov"|betwen = "step" => p.toml:3: unknown key `betwen` of a track, perhaps `between`
[scene]|kind = "slab"|[[track]]|key = "scene.kind"|keys = [[0, 40]] => p.toml:3: track: a track cannot change scene.kind; a film has one scene
[scene]|kind = "slab"|[[track]]|key = "scene.fold_limit"|keys = [[0, 40]] => p.toml:3: track: the plan has no key `scene.fold_limit`; it is one of another kind of scene
[scene]|kind = "slab"|[[track]]|key = "camera.fow"|keys = [[0, 40]] => p.toml:3: track: the plan has no key `camera.fow`, perhaps `camera.fov`
[scene]|kind = "slab"|[[track]]|key = "camera.fov"|keys = [] => p.toml:3: track.camera.fov = []: a track needs one value at least
[scene]|kind = "slab"|[[track]]|key = "camera.fov"|keys = [[0]] => p.toml:3: track.camera.fov = [[0]]: must be a list of [time, value]
[scene]|kind = "slab"|[[track]]|key = "camera.fov"|keys = [[0, 40, "bent"]] => p.toml:3: track.camera.fov = [[0, 40, "bent"]]: between "bent": must be one of "step", "linear", "smooth", "ramp"
[scene]|kind = "slab"|[[track]]|key = "camera.fov"|keys = [[2, 40], [1, 50]] => p.toml:3: track.camera.fov = [[2, 40], [1, 50]]: the times must ascend
[scene]|kind = "slab"|[[track]]|key = "camera.fov"|keys = [[0, 40], [11, 50]] => p.toml:3: track.camera.fov = [[0, 40], [11, 50]]: the time 11 is not within 0 and time.length, 10
[scene]|kind = "slab"|[[track]]|key = "camera.fov"|keys = [[0, 400]] => p.toml:3: track.camera.fov = [[0, 400]]: [400.0]: must be a number from 1 to 360
[scene]|kind = "slab"|[[track]]|key = "march.mode"|keys = [[0, 1]] => p.toml:3: track.march.mode = [[0, 1]]: [1.0]: this key takes no number
[scene]|kind = "slab"|[[track]]|key = "time.fps"|keys = [[0, 25]] => p.toml:3: track.time.fps = [[0, 25]]: time and image stay the same
[scene]|kind = "slab"|[[track]]|key = "camera.fov"|keys = [[0, 40]]|[[track]]|key = "camera.fov"|keys = [[0, 40]] => p.toml:6: track.camera.fov = [[0, 40]]: a second track of this key
[scene]|kind = "slab"|[camera]|target = [0, 0, 0]|[[track]]|key = "camera.eye"|keys = [[0, [0, 0, 0]]] => p.toml:5: track.camera.eye = [[0, [0, 0, 0]]]: at beat 0: the eye and the target are the same point
"#;

#[test]
fn errors_name_line_key_value_and_what_would_do() {
    for line in ERRORS.trim_matches('\n').lines() {
        let (text, says) = line.split_once(" => ").expect(line);
        let e = error(&text.replace('|', "\n"));
        assert!(e.starts_with(says), "{e}\n  should begin with\n{says}");
        assert!(!e.contains('\n'), "one sentence: {e}");
    }
}

/// As above, of the rest of a scene of heights.
const HEIGHTFIELD_ERRORS: &str = r#"
tiles = [1, 2] => p.toml:3: scene.tiles = [1, 2]: the map is repeated along y, but it does not wrap there
field = "fbm:9000x1" => p.toml:3: scene.field = "fbm:9000x1": `9000x1` is not a size
field = "hills" => p.toml:3: scene.field = "hills": hills: there is no such file or field; fields are fbm
field = "none/there.png" => p.toml:3: scene.field = "none/there.png": none/there.png:
map = "exact" => p.toml:3: scene.map = "exact": the tracer `walk` cannot use the cones of the generator `exact`; it can use those of walk, or auto
tracer = "max-mip"|map = "exact" => p.toml:4: scene.map = "exact": the tracer max-mip needs no cones
tracer = "linear-binary"|map = "none/there.exr" => p.toml:4: scene.map = "none/there.exr": the tracer linear-binary needs no cones
map = "exakt" => p.toml:3: scene.map = "exakt": there is no such file or generator; generators are brute,
map = "none/there.exr" => p.toml:3: scene.map = "none/there.exr": none/there.exr:
field = "fbm:8192x8192"|wrap = "xy"|tiles = [256, 256] => p.toml:5: scene.tiles = [256, 256]: 256 tiles of 8192 cells along axis 0 are out of range; there must be at least one tile and at most 65536 cells
field = "fbm:4x1024"|wrap = "y"|tiles = [1, 65] => p.toml:5: scene.tiles = [1, 65]: 65 tiles of 1024 cells along axis 1 are out of range
"#;

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
    for line in HEIGHTFIELD_ERRORS.trim().lines() {
        let (rest, says) = line.split_once(" => ").expect(line);
        let e = error(&of(&rest.replace('|', "\n")));
        assert!(e.starts_with(says), "{e}\n  should begin with\n{says}");
    }
    let most = of("field = \"fbm:8192x1024\"\nwrap = \"xy\"\ntiles = [8, 64]");
    read(&most, "p.toml").expect("as many cells as there may be");
    let tiled = of("field = \"fbm:1024x1024\"\nwrap = \"xy\"");
    let set = Override::read("scene.tiles=[65, 64]").expect("a value");
    let e = read_with(&tiled, "p.toml", &[set]).expect_err("too many");
    let says = "--set scene.tiles=[65, 64]: 65 tiles of 1024 cells along axis 0 are out of range";
    assert!(e.is_usage() && e.to_string().starts_with(says), "{e}");
}

/// What an override's error says.
pub fn set_error(sets: &[&str]) -> String {
    let text =
        "[scene]\nkind = \"distance\"\nformula = \"mandelbox\"\n[camera]\ntarget = [0, 0, 0]\n";
    let sets: Result<Vec<_>, _> = sets.iter().map(|s| Override::read(s)).collect();
    let e = sets.and_then(|s| read_with(text, "p.toml", &s).map(|_| ()));
    let e = e.expect_err("should be refused");
    assert!(e.is_usage(), "{e}");
    e.to_string()
}

/// Overrides, all of which are checked though the last one counts, and how the error
/// begins.
const SET_ERRORS: &str = r#"
camera.fov => --set camera.fov: there is no `=`
fov=3 => --set fov=3: `fov` names no section
=3 => --set =3: `` names no section
.scale=3 => --set .scale=3: `.scale` names no section
.=3 => --set .=3: `.` names no section
cam.fov=3 => --set cam.fov=3: unknown section `cam`
camera.fow=3 => --set camera.fow=3: unknown key, perhaps `fov`
camera.fov=[1 => --set camera.fov=[1: the value is not TOML
camera.eye=[0, 0, 0] => --set camera.eye=[0, 0, 0]: p.toml:5: camera.target = [0, 0, 0]: the eye
camera.fov=0 & camera.fov=50 => --set camera.fov=0: must be
scene.scale=0.5 => --set scene.scale=0.5:
look.mode=pth => --set look.mode=pth: must be one of "quick", "path", perhaps "path"
scene.kind=cube & scene.kind=distance => --set scene.kind=cube: must be one of
scene.formula=cube & scene.formula=balls => --set scene.formula=cube: must be one of
"#;

#[test]
fn errors_of_overrides_name_the_override() {
    for line in SET_ERRORS.trim().lines() {
        let (sets, says) = line.split_once(" => ").expect(line);
        let e = set_error(&sets.split(" & ").collect::<Vec<_>>());
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
