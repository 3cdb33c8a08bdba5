//! Parts of a picture, made by separate processes and joined.

use std::fs;
use std::io::Cursor;
use std::process::Command;

use crate::folder::{Folder, holds, output, said};
use crate::pictures::{exr_layer, values};

/// A picture whose sides are no multiples of anything, through a lens, dithered and flagged.
const PICTURE: &str =
    "mandelbox --device cpu --size 203x139 --samples 2 --set camera.aperture=0.02";

/// Renders all parts of a grid. Returns their names.
fn parts(folder: &Folder, picture: &str, [columns, rows]: [u32; 2]) -> Vec<String> {
    let all = (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r)));
    all.map(|(c, r)| {
        let name = format!("p{c}{r}.exr");
        let tile = format!("--tile {c},{r}/{columns}x{rows} -o {name}");
        folder.done(&format!("render {picture} {tile}"));
        name
    })
    .collect()
}

#[test]
fn joined_parts_have_the_bytes_of_the_whole_picture() {
    let folder = Folder::new();
    // Not in their order.
    let mut names = parts(&folder, PICTURE, [3, 2]);
    names.rotate_left(2);
    let names = names.join(" ");
    for (file, more) in [
        ("png", ""),
        ("png", "--depth 16"),
        ("exr", ""),
        ("jpg", "--quality 80"),
        ("webp", ""),
    ] {
        folder.done(&format!("render {PICTURE} -o whole.{file} {more}"));
        let told = said(&folder.done(&format!("merge {names} -o joined.{file} {more}")));
        holds(&told, &["6 parts by the CPU, f64", "203 x 139"]);
        let [whole, joined] =
            ["whole", "joined"].map(|name| folder.bytes(&format!("{name}.{file}")));
        assert!(whole == joined, "{file} {more}");
    }
    // A joined picture carries its preset.
    folder.done("render joined.png --device cpu -o again.png");
    folder.done(&format!("render {PICTURE} -o whole.png"));
    assert_eq!(folder.bytes("again.png"), folder.bytes("whole.png"));
    let piped = folder.done(&format!("merge {names} -o -"));
    assert!(piped.stdout == folder.bytes("whole.png"));
}

/// The disk is full while a part, or the joined picture, is written: no half of it is left.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_no_half_of_a_part_or_a_joined_picture() {
    let folder = Folder::new();
    let line = format!("render {PICTURE} --tile 0,0/1x1 -o p00.exr");
    let told = said(&folder.limited(&line, 64 * 1024));
    holds(
        &told,
        &["error: p00.exr: cannot be written", "free some space"],
    );
    assert!(folder.files().is_empty(), "{:?}", folder.files());
    let names = parts(&folder, PICTURE, [2, 1]);
    for file in ["png", "exr", "jpg", "webp"] {
        let line = format!("merge {} -o a.{file}", names.join(" "));
        let told = said(&folder.limited(&line, 4 * 1024));
        let error = format!("error: a.{file}: cannot be written");
        holds(&told, &[&error, "free some space"]);
        assert_eq!(folder.files(), names);
    }
    folder.done(&format!("merge {} -o a.png", names.join(" ")));
}

/// Different devices may share a picture.
#[test]
fn the_devices_of_all_parts_are_told() {
    let folder = Folder::new();
    let part = |device: &str, column: u32| {
        let line = format!("render mandelbox --size 128x64 --samples 1 --device {device}");
        let tile = format!("--tile {column},0/2x1 -o p{column}.exr");
        let told = said(&folder.done(&format!("{line} {tile}")));
        let mut lines = told.lines();
        let who = lines.find_map(|l| l.strip_prefix("rendering on "));
        // The reason follows.
        let (name, _) = who.and_then(|who| who.rsplit_once(" (")).expect("a device");
        name.to_string()
    };
    part("cpu", 0);
    let device = part("auto", 1);
    assert!(!device.starts_with("the CPU"), "this needs a GPU adapter");
    let told = said(&folder.done("merge p0.exr p1.exr -o a.png"));
    let of_device = format!("1 part by {device}");
    holds(
        &told,
        &["1 part by the CPU, f64\n", &of_device, "of 2 parts"],
    );
}

/// The light of all parts spreads over each.
#[test]
fn joined_parts_bloom_as_the_picture_does() {
    let folder = Folder::new();
    let bloom = "--set look.bloom=0.3 --set image.background=transparent --set title=Würfel";
    let picture = format!("mandelbox --device cpu --size 150x139 {bloom}");
    let names = parts(&folder, &picture, [2, 2]).join(" ");
    for file in ["png", "webp"] {
        folder.done(&format!("render {picture} -o whole.{file}"));
        folder.done(&format!("merge {names} -o joined.{file}"));
        let [whole, joined] =
            ["whole", "joined"].map(|name| folder.bytes(&format!("{name}.{file}")));
        assert!(whole == joined, "{file}");
    }
}

/// Tiles of the picture end alone, so a part ends them as the picture does.
#[test]
fn parts_end_their_samples_as_the_picture_does() {
    let folder = Folder::new();
    let picture = "mandelbox --device cpu --size 150x139 --samples 32 --until 0.04";
    let names = parts(&folder, picture, [2, 2]).join(" ");
    for file in ["png", "exr"] {
        folder.done(&format!("render {picture} -o whole.{file}"));
        folder.done(&format!("merge {names} -o joined.{file}"));
        let [whole, joined] =
            ["whole", "joined"].map(|name| folder.bytes(&format!("{name}.{file}")));
        assert!(whole == joined, "{file}");
    }
    let counts = values(&exr_layer(&folder.0.join("whole.exr")), "samples.Y");
    assert!(
        [8.0, 32.0].iter().all(|n| counts.contains(n)),
        "no tile ends alone"
    );
}

/// Other programs see where a part lies.
#[test]
fn a_part_is_a_data_window_in_the_display_window() {
    let folder = Folder::new();
    parts(
        &folder,
        "terrain --device cpu --size 203x139 --set scene.field=fbm:64x64",
        [2, 2],
    );
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(folder.bytes("p11.exr")), true);
    let header = &meta.expect("an EXR").headers[0];
    let window = header.shared_attributes.display_window;
    assert_eq!((window.position.0, window.position.1), (0, 0));
    assert_eq!((window.size.0, window.size.1), (203, 139));
    let place = header.own_attributes.layer_position;
    assert_eq!((place.0, place.1), (128, 64));
    assert_eq!((header.layer_size.0, header.layer_size.1), (75, 75));
    let comments = header
        .own_attributes
        .comments
        .clone()
        .expect("comments")
        .to_string();
    holds(&comments, &["device: the CPU, f64", "picture: "]);
    let names: Vec<String> = header
        .channels
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    for name in [
        "R",
        "A",
        "Z",
        "depth.Z",
        "normal.X",
        "position.Y",
        "state.Y",
    ] {
        assert!(names.iter().any(|n| n == name), "{name}: {names:?}");
    }
}

#[test]
fn parts_that_do_not_fit_are_refused_in_a_sentence() {
    let folder = Folder::new();
    let small = "mandelbox --device cpu --size 130x260 --set look.shadow=false";
    parts(&folder, small, [2, 2]);
    let part = |tile: &str, more: &str, name: &str| {
        folder.done(&format!("render {small} {more} --tile {tile} -o {name}"));
    };
    part("0,0/1x2", "", "wide.exr");
    part("1,0/2x3", "", "low.exr");
    part("1,1/2x2", "--set look.fog=0.1", "fog.exr");
    part("1,1/2x2", "--stats s.json", "counted.exr");
    folder.done(&format!("render {small} -o whole.exr"));
    let cut = folder.bytes("p11.exr");
    folder.write("cut.exr", &cut[..cut.len() - 40]);
    folder.write("head.exr", &cut[..300]);
    folder.write("text.exr", "nothing");
    for (names, code, says) in [
        (
            "p00.exr p10.exr p01.exr",
            2,
            "no part begins at column 64, row 128|all parts",
        ),
        ("p00.exr p01.exr p11.exr", 2, "column 64, row 0"),
        ("p10.exr p01.exr p11.exr", 2, "column 0, row 0"),
        ("p00.exr p10.exr", 2, "column 0, row 128"),
        (
            "p00.exr p10.exr p01.exr p11.exr p11.exr",
            1,
            "`p11.exr` and `p11.exr` overlap|once",
        ),
        ("p00.exr wide.exr p10.exr p01.exr p11.exr", 1, "overlap"),
        (
            "p00.exr low.exr p01.exr p11.exr",
            1,
            "another grid|one --tile grid",
        ),
        (
            "p00.exr p10.exr p01.exr fog.exr",
            1,
            "`p00.exr` and `fog.exr`|different pictures|same",
        ),
        (
            "p00.exr p10.exr p01.exr counted.exr",
            1,
            "different channels|--stats",
        ),
        (
            "p00.exr p10.exr p01.exr whole.exr",
            1,
            "whole.exr|no part|--tile",
        ),
        (
            "p00.exr p10.exr p01.exr cut.exr",
            1,
            "cut.exr|cannot be read",
        ),
        (
            "p00.exr p10.exr p01.exr head.exr",
            1,
            "head.exr|cannot be read",
        ),
        ("p00.exr p10.exr p01.exr text.exr", 1, "text.exr|no EXR"),
        (
            "p00.exr p10.exr p01.exr none.exr",
            1,
            "none.exr|check its path",
        ),
    ] {
        folder.fails(&format!("merge {names} -o a.png"), code, says);
    }
    let all = "p00.exr p10.exr p01.exr p11.exr";
    folder.fails(
        &format!("merge {all} -o p11.exr"),
        2,
        "would overwrite a part|p11.exr",
    );
    folder.fails(&format!("merge {all} -o a.txt"), 2, "a.txt|.exr");
    folder.fails(&format!("merge {all} -o a.exr --depth 16"), 2, "--depth");
    for (wrong, says) in [
        ("--tile 2,0/2x2 -o a.exr", "--tile|from 0"),
        ("--tile 0,0/4x1 -o a.exr", "multiples of 64|3x5"),
        ("--tile 0,0/2x2 -o a.png", ".exr|merge"),
        ("--tile 0,0/2x2", "--output"),
        ("--tile 0,0/2x2 -o a.exr --resume", "--resume"),
        ("--tile 0,0/2x2 -o a.exr --layer depth", "--layer"),
    ] {
        folder.fails(&format!("render {small} {wrong}"), 2, says);
    }
}

/// The array job of `scripts/slurm-array`, with what Slurm sets, and without Slurm.
#[cfg(unix)]
#[test]
fn an_array_job_renders_the_parts_of_a_picture() {
    let folder = Folder::new();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/scripts/slurm-array");
    let task = |id: &str, args: &str| {
        let mut command = Command::new("bash");
        command
            .arg(script)
            .args(args.split(' '))
            .current_dir(&folder.0);
        command.env("CONEMARCH", env!("CARGO_BIN_EXE_conemarch"));
        let command = match id {
            "" => command.env_remove("SLURM_ARRAY_TASK_ID"),
            id => command.env("SLURM_ARRAY_TASK_ID", id),
        };
        let ended = output(command);
        (ended.status.code(), said(&ended))
    };
    let job = format!("parts/of 2x2 {PICTURE}");
    for id in ["3", "0", "2", "1", "2"] {
        let (code, told) = task(id, &job);
        assert_eq!(code, Some(0), "{told}");
    }
    // The last one was there.
    let written = |name: &str| {
        fs::metadata(folder.0.join(name))
            .and_then(|m| m.modified())
            .expect(name)
    };
    assert!(written("parts/of/part-2.exr") <= written("parts/of/part-1.exr"));
    let all: Vec<String> = (0..4).map(|i| format!("parts/of/part-{i}.exr")).collect();
    folder.done(&format!("merge {} -o joined.png", all.join(" ")));
    folder.done(&format!("render {PICTURE} -o whole.png"));
    assert_eq!(folder.bytes("joined.png"), folder.bytes("whole.png"));
    for (id, args, says) in [
        ("", job.as_str(), "--array=0-3"),
        ("4", job.as_str(), "0 to 3"),
        ("0", "parts 2 mandelbox", "usage: sbatch"),
        ("0", "parts 2x2", "usage: sbatch"),
    ] {
        let (code, told) = task(id, args);
        assert_eq!(code, Some(2), "{told}");
        holds(&told, &[says]);
    }
}
