//! Bad input as tables: arguments, exit code, and the words that the one sentence must hold,
//! with `|` between them. Nothing is written.

use std::fs;

use crate::folder::{Folder, output, said, text};
use crate::tools::tiny;

/// What `render mandelbox` answers to wrong options; `--explain` answers the same.
const OPTIONS: &str = r#"
--layer colour ; 2 ; --layer|possible values: color, depth
--depth 12 ; 2 ; --depth|8, 16
--quality 0 ; 2 ; --quality|must be a whole number from 1 to 100
-o a.gif ; 2 ; `a.gif`|.png|.jpg|.webp|.exr
-o a ; 2 ; `a`|.png|.exr
-o a.exr --depth 16 ; 2 ; EXR|--depth
-o a.exr --layer depth ; 2 ; EXR|--layer
-o a.jpg --depth 16 ; 2 ; JPEG|--depth
-o a.png --quality 90 ; 2 ; JPEG|--quality
-o - --stats - ; 2 ; --stats
-o a.png --stats a.png ; 2 ; --stats
-o a.png --stats ./a.png ; 2 ; --stats
--layer variance --samples 1 ; 2 ; one sample has no variance|--samples 16
--until nan ; 2 ; --until|a number from 0 to 1
--until -0.1 ; 2 ; --until|a number from 0 to 1
--until 2 ; 2 ; --until|a number from 0 to 1
--samples 1000000000 ; 2 ; --samples|65536
--set image.until=-1 ; 2 ; image.until=-1: must be a number from 0 to 1
-o no/a.png ; 1 ; no/a.png|no folder `no`
--stats no/s.json ; 1 ; no/s.json|no folder `no`
-o empty.toml/a.png ; 1 ; empty.toml/a.png
-o folder.png ; 1 ; folder.png: is a folder
--set camera.fov=400 ; 2 ; --set camera.fov=400: must be a number from 1 to 360
--set camera.fov=200 ; 2 ; --set camera.fov=200: |perspective shows at most 170 degrees|fisheye
--set camera.fov=200 --set camera.projection=orthographic ; 2 ; orthographic shows at most 170
--set camera.projection=fisheye --set camera.aperture=0.1 ; 2 ; fisheye has no lens|perspective
--set camera.projection=fishy ; 2 ; one of "perspective", "orthographic", "fisheye", "equirectangular"
--set camera.fov=nan ; 2 ; --set camera.fov=nan
--set camera.fow=40 ; 2 ; unknown key|`fov`
--set cam.fov=40 ; 2 ; unknown section `cam`
--set camera.fov ; 2 ; no `=`|camera.fov=30
--set camera.eye=[4.16,-1.4,3.84] ; 2 ; --set camera.eye=[4.16,-1.4,3.84]|same point
--set scene.formula=mandelbx ; 2 ; perhaps "mandelbox"
--size=0x5 ; 2 ; --size|like 1280x720
--size=5x0 ; 2 ; --size|like 1280x720
--size=abc ; 2 ; --size|like 1280x720
--samples 0 ; 2 ; --samples|must be a whole number from 1 to 65536
--size=99999x1 ; 2 ; --size|like 1280x720
--size=64 ; 2 ; --size|like 1280x720
--size=-1x5 ; 2 ; --size|like 1280x720
--size= ; 2 ; --size|like 1280x720
--size=16384x1 -o a.webp ; 2 ; WebP|16383
--device 99 ; 1 ; there is no adapter|99|cpu
--device foo ; 1 ; there is no|foo|cpu
--size 25x16 --set camera.stereo=pair ; 2 ; camera.stereo|even width|26
--set camera.stereo=pair --set camera.projection=orthographic ; 2 ; camera.stereo|perspective|orthographic
--set camera.rise=0.2 --set camera.projection=fisheye ; 2 ; camera.rise|perspective|fisheye
--size 128x64 --set camera.stereo=pair --tile 0,0/2x1 -o a.exr ; 2 ; --tile|camera.stereo=off
--set scene.kind=heightfield --set look.glow=1 ; 2 ; look.glow|heightfields|fog_height
--set camera.stereo=pair --layer error ; 2 ; error|camera.stereo=off
"#;

const PRESETS: &str = r#"
mandlebox ; 2 ; `mandlebox`|perhaps `mandelbox`|`conemarch presets` lists
missing.jpg ; 1 ; missing.jpg: cannot be read
- ; 2 ; no preset is called `-`
empty.toml ; 1 ; empty.toml: scene.kind is missing
binary.toml ; 1 ; binary.toml: is not text in UTF-8
large.toml ; 1 ; large.toml: is larger than 1 MiB
broken.toml ; 1 ; broken.toml:5: camera.fov = 400: must be a number from 1 to 360
syntax.toml ; 1 ; syntax.toml:2: this is not TOML
box.fract ; 1 ; box.fract: is a settings file of Mandelbulber|presets of conemarch
comment.txt ; 1 ; comment.txt: is a settings file of Mandelbulber
section.txt ; 1 ; section.txt: is a settings file of Mandelbulber
folder.toml ; 1 ; folder.toml: is a folder
missing.toml ; 1 ; missing.toml: cannot be read
"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("empty.toml", "");
    folder.write("binary.toml", [0xFF, 0xFE, 0x00, 0x80]);
    folder.write("large.toml", vec![b'#'; 1 << 21]);
    folder.write(
        "broken.toml",
        "[scene]\nkind = \"slab\"\n\n[camera]\nfov = 400\n",
    );
    folder.write("syntax.toml", "[scene]\nkind = \n");
    folder.write("box.fract", "x 1;\n");
    folder.write("comment.txt", "\u{feff}# Mandelbulber settings file\n");
    folder.write("section.txt", "\n[main_parameters]\nx 1;\n");
    for name in ["folder.toml", "folder.png"] {
        fs::create_dir(folder.0.join(name)).expect("a folder");
    }
    folder
}

/// Runs each line of a table; `args` makes the command out of its first column.
fn all_fail(folder: &Folder, table: &str, args: impl Fn(&str) -> String) {
    for line in table.trim().lines() {
        let columns: Vec<&str> = line.split(" ; ").collect();
        let [more, code, says] = columns[..] else {
            panic!("three columns: {line}");
        };
        folder.fails(&args(more), code.parse().expect(line), says);
    }
}

#[test]
fn wrong_options_of_a_render() {
    let folder = folder();
    for end in ["", "--explain"] {
        all_fail(&folder, OPTIONS, |more| match more.contains("--device") {
            true => format!("render mandelbox {more} {end}"),
            false => format!("render mandelbox --device cpu {more} {end}"),
        });
    }
}

#[test]
fn wrong_presets() {
    let folder = folder();
    all_fail(&folder, PRESETS, |preset| tiny(preset, ""));
    folder.fails_with(&["render", ""], 2, "<PRESET>");
    folder.fails("presets none.png", 1, "none.png: cannot be read");
}

#[test]
fn devices_of_blanks_and_of_no_adapter() {
    let folder = Folder::new();
    for device in ["--device=", "--device= ", "--device=\t"] {
        for verb in [["render", "mandelbox"], ["bench", "steps"]] {
            folder.fails_with(&[&verb[..], &[device]].concat(), 2, "--device|auto");
        }
    }
    let nobody = ["render", "mandelbox", "--device", "no such adapter"];
    folder.fails_with(&nobody, 1, "there is no adapter|no such adapter|cpu");
}

#[cfg(target_os = "linux")]
#[test]
fn what_does_not_fit_into_memory_is_refused_with_a_size_that_does() {
    let folder = Folder::new();
    let huge = "--device cpu --size 65536x65536";
    let says = "65536x65536|iB of memory|--size ";
    // A PNG of colours and an EXR are made in bands.
    let render = format!("render mandelbox {huge} --layer depth -o a.png");
    folder.fails(&render, 1, says);
    for verb in ["error", "steps", "calibrate"] {
        let says = "bench-far|iB of memory|would fit";
        folder.fails(&format!("bench {verb} bench-far {huge}"), 1, says);
    }
    // The size that is advised is taken.
    let said = said(&output(&mut folder.command(&render)));
    let advised = said.split("--size ").nth(1).expect("a size");
    let advised = advised.split(' ').next().unwrap_or_default();
    let explain = "render mandelbox --device cpu --layer depth -o a.png --explain --size";
    folder.done(&format!("{explain} {advised}"));
}

/// What `bench` answers. A folder that was made is removed again after a failure.
const BENCHES: &str = r#"
error bench-fat ; 2 ; bench-fat|bench-far
error no.toml ; 1 ; no.toml
error bench-far --json no/a.json ; 1 ; no
error bench-far --plot no/a.svg ; 1 ; no
error bench-far --plot x.png ; 2 ; x.png|.svg
error bench-far --plot svg ; 2 ; `svg`|.svg
error bench-far --json a --csv ./a ; 2 ; --json and --csv|`./a`
error bench-far --csv - --plot - ; 2 ; --csv and --plot|`-`
steps bench-far --mode fast ; 2 ; fast|safe|slides-even
steps bench-far --csv no/a.csv ; 1 ; no
steps bench-far a/bench-far.toml --heat h ; 2 ; two|`bench-far`
steps bench-far --heat h/i --json no/a.json ; 1 ; no/a.json
steps bench-far --heat file ; 1 ; file
calibrate bench-far --budget 2 ; 2 ; 0.5
calibrate bench-far --budget nan ; 2 ; 0.5
calibrate bench-far --rays 0 ; 2 ; 100
error bench-far --device nothing ; 1 ; nothing|cpu
errors ; 2 ; errors
cones fbn ; 2 ; fbn|fbm, ridges
cones fbm --size 9999x9 ; 2 ; 9999
"#;

#[test]
fn wrong_measurements() {
    let folder = Folder::new();
    folder.write("file", "of nothing");
    fs::create_dir(folder.0.join("a")).expect("a folder");
    folder.write("a/bench-far.toml", text(&folder.done("presets bench-far")));
    all_fail(&folder, BENCHES, |more| match more.starts_with("cones") {
        true => format!("bench {more}"),
        false => format!("bench {more} --size 40x24"),
    });
}
