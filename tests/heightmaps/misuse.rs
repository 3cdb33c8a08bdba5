//! `conemarch conemap`: a sentence and an exit code for everything that is wrong, and no file.

use std::fs;

use conemarch::heightfield::conemap::generate::generator::Generator;
use exr::prelude::FlatSamples;
use png::{BitDepth, ColorType};

use crate::commands::{done, make, slope, with_rock, words};
use crate::folder::{Folder, said};
use crate::pictures::{exr, png, wide};

/// Checks that command lines after `conemap` fail with a code and some words each.
fn all_fail(folder: &Folder, code: i32, cases: &[(&str, &[&str])]) {
    for (line, telling) in cases {
        let mut line = format!("conemap {line}");
        if line.starts_with("conemap make") && !line.contains("--device") {
            line.push_str(" --device cpu");
        }
        folder.fails(&words(&line), code, telling);
    }
}

/// A PNG of another program with four channels.
fn theirs() -> Vec<u8> {
    png([4, 4], ColorType::Rgba, BitDepth::Eight, &[9; 4 * 16])
}

#[test]
fn a_map_never_takes_the_place_of_its_heights() {
    let folder = with_rock();
    make(&folder, "rock.png -o m.png");
    let before = folder.bytes("m.png");
    all_fail(
        &folder,
        2,
        &[
            ("make rock.png -o rock.png", &["rock.png", "another name"]),
            ("make rock.png -o ./rock.png", &["rock.png", "another name"]),
            (
                "inspect rock.png -o rock.png",
                &["rock.png", "another name"],
            ),
            ("convert m.png -o m.png", &["m.png", "another name"]),
        ],
    );
    assert_eq!(folder.bytes("m.png"), before);
    assert_eq!(folder.bytes("rock.png"), slope());
}

#[test]
fn options_without_effect_are_wrong_usage() {
    let folder = with_rock();
    make(&folder, "sine:4x4 -o m.png");
    make(&folder, "sine:4x4 -o m.exr");
    folder.write("theirs.png", theirs());
    done(&folder, "conemap inspect theirs.png --from dummer --wrap x");
    for file in ["m.png", "m.exr"] {
        for line in [
            format!("convert {file} -o a.exr --from relief"),
            format!("inspect {file} --from dummer"),
        ] {
            all_fail(&folder, 2, &[(&line, &[file, "--from", "leave it out"])]);
        }
        for option in ["--wrap x", "--invert", "--normalize", "--size 4x4"] {
            let name = words(option)[0];
            let line = format!("inspect {file} {option}");
            all_fail(&folder, 2, &[(&line, &[file, name, "--heights"])]);
        }
    }
    all_fail(
        &folder,
        2,
        &[
            (
                "inspect theirs.png --from dummer --invert",
                &["--invert", "--heights"],
            ),
            ("inspect rock.png --heights rock.png", &["not a cone map"]),
            (
                "make sine:4x4 --layout dummer --depth 3 -o a.png",
                &["--depth", "relief", "dummer"],
            ),
            (
                "make sine:4x4 --layout pair --depth 3 -o a.png",
                &["--depth", "relief", "pair"],
            ),
            ("make sine:4x4 --depth 3", &["EXR", "--depth"]),
            (
                "convert m.exr -o a.png --depth 3",
                &["--depth", "relief", "dummer"],
            ),
            (
                "make sine:4x4 --layout pair --slopes half -o a.png",
                &["--slopes", "dummer", "pair"],
            ),
            (
                "make sine:4x4 --layout relief --slopes half -o a.png",
                &["--slopes", "dummer", "relief"],
            ),
            ("make sine:4x4 --slopes half", &["EXR", "--slopes"]),
        ],
    );
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let folder = Folder::new();
    make(&folder, "sine:4x4 -o m.exr");
    let generators = Generator::ALL.map(Generator::name).join(", ");
    all_fail(
        &folder,
        2,
        &[
            ("make fbm:4x4 --generator quick", &["quick", &generators]),
            ("make fbm:4x4 --wrap z", &["--wrap", "none, x, y, xy"]),
            ("make fbm:4x4 -o a.jpg", &["`a.jpg`", ".png", ".exr"]),
            ("make fbm:4x4 -o a.exr --bits 8", &["EXR", "--bits"]),
            ("make fbm:4x4 -o a.exr --layout pair", &["EXR", "--layout"]),
            (
                "make fbm:4x4 -o a.png --layout full",
                &["dummer, relief, pair, quad"],
            ),
            (
                "make fbm:4x4 -o a.png --layout quad",
                &["`quad`", "four ratios"],
            ),
            ("make fbm:4x4 -o a.png --bits 12", &["--bits", "8, 16"]),
            ("make fbm:4x4 --depth 0", &["--depth", "0.001 to 1000"]),
            ("make fbm:4x4 --offset 2", &["--offset", "walk", "exact"]),
            ("make fbm:4x4 --boxes", &["--boxes", "walk"]),
            (
                "make fbm:4x4 --search-steps 9",
                &["--search-steps", "relaxed-search"],
            ),
            (
                "make fbm:4x4 --generator walk --offset 0",
                &["an offset of 0"],
            ),
            (
                "make fbm:4x4 --generator walk --offset nan",
                &["an offset of NaN"],
            ),
            ("make fbm:4x4 --size 4x4", &["fbm:4x4", "--size"]),
            ("make fbm:4x4 --size 9000x1", &["--size", "8192"]),
            ("make fmb:4x4", &["fmb:4x4", "fields are fbm, ridges"]),
            ("make fbm:4x4,seed=x", &["seed=x"]),
            ("inspect nothing", &["nothing", "fields are fbm"]),
            ("inspect m.exr -o a.exr", &["a.exr", ".png"]),
            ("convert m.exr", &["-o MAP.png"]),
            ("convert m.exr -o a.bmp", &["a.bmp"]),
            ("convert m.exr -o a.png --wrap x", &["--from"]),
        ],
    );
    folder.fails(&["conemap"], 2, &["a command is missing"]);
}

#[test]
fn bad_heights_are_exit_code_1() {
    let folder = Folder::new();
    let one = |z: f32| exr([2, 1], vec![("Y", FlatSamples::F32(vec![0.5, z]))]);
    folder.write("nan.exr", one(f32::NAN));
    folder.write("inf.exr", one(f32::INFINITY));
    folder.write("metres.exr", one(812.5));
    folder.write("empty.png", []);
    folder.write("cut.png", &slope()[..60]);
    folder.write("text.png", "heights");
    folder.write("short-4x4.raw", [0; 12]);
    fs::create_dir(folder.0.join("folder.png")).expect("a folder");
    let cases: [(&str, &[&str]); 9] = [
        (
            "nan.exr",
            &["nan.exr: the height at column 1, row 0 is NaN"],
        ),
        (
            "inf.exr",
            &["inf.exr: the height at column 1, row 0 is inf"],
        ),
        ("metres.exr", &["from 0.5 to 812.5", "--normalize"]),
        ("empty.png", &["empty.png: is empty"]),
        ("cut.png", &["cut.png: is a PNG that ends before its end"]),
        ("text.png", &["text.png: is neither PNG, EXR nor TIFF"]),
        ("short-4x4.raw", &["has 12 bytes", "64"]),
        ("folder.png", &["folder.png: is a folder"]),
        ("missing.png", &["missing.png: cannot be read"]),
    ];
    for (heights, telling) in cases {
        let lines = ["make -o m.exr", "inspect -o m.png"];
        for line in lines.map(|line| line.replace(" -o", &format!(" {heights} -o"))) {
            all_fail(&folder, 1, &[(&line, telling)]);
        }
    }
    make(&folder, "metres.exr --normalize -o m.exr");
    // Alpha is not a height, and a note says so.
    let alpha = wide(&[13107, 0, 65535, 65535]);
    let alpha = png([2, 1], ColorType::GrayscaleAlpha, BitDepth::Sixteen, &alpha);
    folder.write("ga.png", alpha);
    let said = said(&make(&folder, "ga.png -o m.exr"));
    assert!(said.contains("note: ga.png is transparent"), "{said}");
}

#[test]
fn bad_maps_and_places_are_exit_code_1() {
    let folder = with_rock();
    make(&folder, "rock.png -o m.png");
    let map = folder.bytes("m.png");
    folder.write("cut.png", &map[..map.len() * 2 / 3]);
    folder.write("text.txt", "nothing");
    folder.write("old.exr", "precious");
    fs::create_dir(folder.0.join("folder.png")).expect("a folder");
    all_fail(
        &folder,
        1,
        &[
            (
                "convert rock.png -o b.exr",
                &["rock.png", "conemap make", "--from"],
            ),
            (
                "convert cut.png -o b.exr",
                &["cut.png", "ends before its end"],
            ),
            ("inspect cut.png", &["cut.png", "ends before its end"]),
            ("convert text.txt -o b.exr", &["text.txt", "PNG or EXR"]),
            (
                "convert missing.png -o b.exr",
                &["missing.png: cannot be read"],
            ),
            (
                "convert rock.png -o b.exr --from dummer",
                &["rock.png", "1 channels"],
            ),
            ("make rock.png -o no/b.exr", &["no/b.exr", "no folder `no`"]),
            ("convert m.png -o no/b.exr", &["no/b.exr", "no folder `no`"]),
            ("make rock.png -o folder.png", &["is a folder"]),
            ("inspect m.png -o no/a.png", &["no/a.png"]),
            (
                "make sine:4x4 --device 99",
                &["there is no adapter", "99", "cpu"],
            ),
            ("make cut.png -o old.exr", &["cut.png"]),
        ],
    );
    // What was there stays, whatever fails.
    assert_eq!(folder.bytes("old.exr"), b"precious");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let folder = Folder::new();
    std::os::unix::fs::symlink("/dev/full", folder.0.join("full.exr")).expect("a link");
    let telling = ["full.exr", "No space left"];
    all_fail(&folder, 1, &[("make sine:8x8 -o full.exr", &telling)]);
}
