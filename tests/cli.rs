//! The command line is a contract: every verb, every exit code, one sentence for every
//! error, and no file that should not be there.
//!
//! Pictures are tiny and made by the CPU executor, so that no adapter is needed.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod folder;
}
use common::folder::{Folder, interrupt, said, text};

/// A tiny render by the CPU executor, with more arguments.
fn tiny<'a>(preset: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["render", preset, "--device", "cpu", "--size", "24x16"];
    args.extend(more);
    args
}

/// A decoded PNG.
struct Picture {
    info: png::Info<'static>,
    pixels: Vec<u8>,
}

fn decode(bytes: &[u8]) -> Picture {
    let decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    let mut reader = decoder.read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut pixels).expect("all pixels");
    let info = reader.info().clone();
    Picture { info, pixels }
}

#[test]
fn help_version_and_a_missing_verb() {
    let folder = Folder::new();
    let help = text(&folder.done(&["--help"]));
    for verb in ["render", "presets", "devices", "completions"] {
        assert!(help.contains(verb), "{help}");
    }
    assert!(text(&folder.done(&["--version"])).starts_with("conemarch "));
    let help = text(&folder.done(&["render", "--help"]));
    for option in [
        "--output",
        "--size",
        "--set",
        "--device",
        "--layer",
        "--depth",
        "--stats",
        "--explain",
        "nearest black",
    ] {
        assert!(help.contains(option), "{option}: {help}");
    }
    folder.fails(&[], 2, &["a command is missing"]);
    folder.fails(&["rendr"], 2, &["rendr", "similar", "'render'"]);
    folder.fails(&["render"], 2, &["<PRESET>"]);
    folder.fails(&["render", "mandelbox", "--nope"], 2, &["--nope"]);
}

#[test]
fn presets_are_listed_by_line_and_printed_by_name() {
    let folder = Folder::new();
    let list = text(&folder.done(&["presets"]));
    let names: Vec<&str> = list.lines().filter_map(|l| l.split("  ").next()).collect();
    let sorted = {
        let mut names = names.clone();
        names.sort_unstable();
        names
    };
    assert_eq!(names, sorted);
    assert!(
        names.contains(&"mandelbox") && names.contains(&"bench-far"),
        "{list}"
    );
    assert!(
        list.lines().all(|l| l.contains("  ") && l == l.trim_end()),
        "{list}"
    );
    for name in names {
        let preset = text(&folder.done(&["presets", name]));
        folder.write("copy.toml", &preset);
        let one = text(&folder.done(&["render", name, "--explain"]));
        let two = text(&folder.done(&["render", "copy.toml", "--explain"]));
        assert_eq!(one, two);
    }
    folder.fails(&["presets", "mandlebox"], 2, &["mandlebox", "`mandelbox`"]);
}

#[test]
fn devices_always_has_the_cpu() {
    let folder = Folder::new();
    let list = text(&folder.done(&["devices"]));
    assert!(list.starts_with("index  name"), "{list}");
    assert!(list.lines().any(|l| l.starts_with("cpu ")), "{list}");
}

#[test]
fn completions_for_every_shell() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = text(&folder.done(&["completions", shell]));
        assert!(script.contains("conemarch"), "{shell}");
    }
    folder.fails(&["completions", "tcsh"], 2, &["tcsh", "bash"]);
}

#[test]
fn explain_renders_nothing() {
    let folder = Folder::new();
    let explained = text(&folder.done(&["render", "mandelbox", "--explain", "--size", "64x64"]));
    assert!(explained.starts_with("64 x 64, mode safe"), "{explained}");
    assert!(
        explained.contains("wgsl/formula/mandelbox.wgsl"),
        "{explained}"
    );
    assert!(folder.files().is_empty());
}

#[test]
fn a_render_is_named_after_its_preset_and_renders_again() {
    let folder = Folder::new();
    let output = folder.done(&tiny("mandelbox", &["--set", "camera.fov=30"]));
    assert_eq!(folder.files(), ["mandelbox.png"]);
    let said = said(&output);
    assert!(said.contains("rendering on the CPU"), "{said}");
    let summary = said.lines().last().unwrap_or_default();
    assert!(
        summary.starts_with("mandelbox.png  24 x 16  march and trace "),
        "{said}"
    );
    assert!(
        summary.contains(" ms, colour ") && summary.contains(" %, unconverged "),
        "{said}"
    );

    let picture = decode(&folder.bytes("mandelbox.png"));
    assert_eq!((picture.info.width, picture.info.height), (24, 16));
    assert_eq!(picture.info.color_type, png::ColorType::Rgb);
    assert_eq!(picture.info.bit_depth, png::BitDepth::Eight);
    assert!(picture.info.srgb.is_some());
    let even = picture.pixels.chunks(3).all(|p| p == &picture.pixels[..3]);
    assert!(!even, "the picture is of one colour");

    // The picture carries its plan: no option is needed to make it again.
    folder.done(&[
        "render",
        "mandelbox.png",
        "--device",
        "cpu",
        "-o",
        "again.png",
    ]);
    assert_eq!(folder.bytes("mandelbox.png"), folder.bytes("again.png"));
    // And overrides apply to it, so that equal bytes above mean something.
    let more = [
        "render",
        "mandelbox.png",
        "--device",
        "cpu",
        "-o",
        "other.png",
        "--set",
        "camera.fov=31",
    ];
    folder.done(&more);
    assert_ne!(folder.bytes("mandelbox.png"), folder.bytes("other.png"));
}

#[test]
fn standard_output_gets_the_same_bytes_as_a_file() {
    let folder = Folder::new();
    folder.done(&tiny("mandelbox", &["-o", "a.png"]));
    let piped = folder.done(&tiny("mandelbox", &["-o", "-"]));
    assert_eq!(piped.stdout, folder.bytes("a.png"));
    assert_eq!(folder.files(), ["a.png"]);
}

#[test]
fn layers_and_depths_are_what_they_say() {
    let folder = Folder::new();
    let color = {
        folder.done(&tiny("mandelbox", &["-o", "color.png"]));
        decode(&folder.bytes("color.png")).pixels
    };
    for layer in ["depth", "normal", "position", "steps", "state"] {
        for (bits, bytes) in [("8", 1), ("16", 2)] {
            folder.done(&tiny(
                "mandelbox",
                &["--layer", layer, "--depth", bits, "-o", "l.png"],
            ));
            let picture = decode(&folder.bytes("l.png"));
            let channels = if layer == "depth" { 1 } else { 3 };
            assert_eq!(
                picture.pixels.len(),
                24 * 16 * channels * bytes,
                "{layer} {bits}"
            );
            assert_ne!(picture.pixels, color, "{layer} shows colour");
            if layer == "depth" {
                // The box does not reach the corner: sky, which is white.
                assert!(picture.pixels[..bytes].iter().all(|b| *b == 255));
                assert!(
                    picture
                        .pixels
                        .chunks(bytes)
                        .any(|p| p.iter().all(|b| *b == 0))
                );
            }
            if layer == "state" && bytes == 1 {
                assert_eq!(picture.pixels[..3], [23, 38, 77], "sky is dark blue");
            }
        }
    }
    // 16 bits are more than 8 twice.
    folder.done(&tiny("mandelbox", &["--depth", "16", "-o", "deep.png"]));
    let deep = decode(&folder.bytes("deep.png")).pixels;
    assert!(deep.chunks(2).any(|p| p[0] != p[1]));
    let off = deep
        .chunks(2)
        .zip(&color)
        .filter(|(d, c)| d[0].abs_diff(**c) > 1);
    assert_eq!(off.count(), 0, "8 and 16 bits show different pictures");
}

#[test]
fn an_exr_has_exactly_the_promised_channels() {
    let folder = Folder::new();
    let mut promised = vec![
        "R",
        "G",
        "B",
        "depth.Z",
        "normal.X",
        "normal.Y",
        "normal.Z",
        "position.X",
        "position.Y",
        "position.Z",
        "state.Y",
    ];
    promised.sort_unstable();
    folder.done(&tiny("mandelbox", &["-o", "a.exr"]));
    assert_eq!(channels(&folder.0.join("a.exr")), promised);
    promised.push("steps.Y");
    folder.done(&tiny("mandelbox", &["-o", "b.exr", "--stats", "s.json"]));
    assert_eq!(channels(&folder.0.join("b.exr")), promised);

    let depth = values(&folder.0.join("a.exr"), "depth.Z");
    let state = values(&folder.0.join("a.exr"), "state.Y");
    assert_eq!(depth.len(), 24 * 16);
    for (t, s) in depth.iter().zip(&state) {
        assert_eq!(t.is_infinite(), *s == 0.0, "depth {t}, state {s}");
    }
    assert!(state.contains(&1.0) && state.contains(&0.0));
}

fn exr_layer(
    path: &Path,
) -> exr::prelude::Layer<exr::prelude::AnyChannels<exr::prelude::FlatSamples>> {
    use exr::prelude::*;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels();
    let image = image.first_valid_layer().all_attributes();
    image.from_file(path).expect("an EXR").layer_data
}

fn channels(path: &Path) -> Vec<String> {
    let layer = exr_layer(path);
    let list = &layer.channel_data.list;
    for channel in list {
        assert!(matches!(
            channel.sample_data,
            exr::prelude::FlatSamples::F32(_)
        ));
    }
    let mut names: Vec<String> = list.iter().map(|c| c.name.to_string()).collect();
    names.sort_unstable();
    names
}

fn values(path: &Path, name: &str) -> Vec<f32> {
    let layer = exr_layer(path);
    let list = &layer.channel_data.list;
    let channel = list
        .iter()
        .find(|c| c.name.to_string() == name)
        .expect(name);
    channel.sample_data.values_as_f32().collect()
}

#[test]
fn stats_have_the_promised_fields() {
    let folder = Folder::new();
    folder.done(&tiny("mandelbox", &["--stats", "s.json"]));
    let piped = folder.done(&tiny("mandelbox", &["--stats", "-"]));
    for bytes in [folder.bytes("s.json"), piped.stdout] {
        let stats: Value = serde_json::from_slice(&bytes).expect("JSON");
        let mut names: Vec<&str> = stats
            .as_object()
            .expect("an object")
            .keys()
            .map(String::as_str)
            .collect();
        names.sort_unstable();
        let promised = [
            "backend",
            "device",
            "evaluations_per_pixel",
            "hit",
            "iterations_per_pixel",
            "mode",
            "passes",
            "preset",
            "size",
            "sky",
            "unconverged",
            "undecided",
            "wall_ms",
        ];
        assert_eq!(names, promised);
        assert_eq!(stats["preset"], "mandelbox");
        assert_eq!(stats["size"], serde_json::json!([24, 16]));
        assert_eq!(stats["backend"], "cpu");
        assert_eq!(stats["mode"], "safe");
        let share = |name: &str| stats[name].as_f64().expect(name);
        let all = share("hit") + share("sky") + share("unconverged");
        assert!((all - 1.0).abs() < 1e-12 && share("hit") > 0.0 && share("hit") < 1.0);
        let passes = stats["passes"].as_array().expect("a list");
        let names: Vec<&str> = passes.iter().filter_map(|p| p["name"].as_str()).collect();
        let promised = [
            "march 1/16",
            "march 1/8",
            "march 1/4",
            "march 1/2",
            "trace",
            "color",
        ];
        assert_eq!(names, promised);
        for pass in passes {
            assert_eq!(pass.as_object().expect("an object").len(), 6, "{pass}");
            assert!(pass["wall_ms"].is_number(), "{pass}");
            assert_eq!(
                pass["evaluations"].is_null(),
                pass["name"] == "color",
                "{pass}"
            );
            assert!(pass["gpu_ms"].is_null(), "the CPU has no device time");
        }
        let sum: f64 = passes
            .iter()
            .filter_map(|p| p["evaluations"].as_f64())
            .sum();
        assert!((sum / (24.0 * 16.0) - share("evaluations_per_pixel")).abs() < 1e-9);
    }
}

#[test]
fn what_a_heightfield_prepares_is_told_apart() {
    let folder = Folder::new();
    let small = "scene.field=\"fbm:33x25\"";
    let args = ["--set", small, "--stats", "-", "-o", "a.png"];
    let output = folder.done(&tiny("terrain", &args));
    let line = said(&output);
    assert!(
        line.contains("cone map ") && line.contains(" ms, march"),
        "{line}"
    );
    let stats: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let first = &stats["passes"][0];
    assert_eq!(
        (&first["name"], &first["cells"]),
        (&"prepare".into(), &(32 * 24).into())
    );
    assert!(first["evaluations"].is_null());
    // It is no part of march and trace, whose figures are whole.
    assert!(stats["evaluations_per_pixel"].as_f64() > Some(0.0));
    let walls = stats["passes"].as_array().expect("a list")[1..6].iter();
    let sum: f64 = walls.filter_map(|p| p["wall_ms"].as_f64()).sum();
    let wall = stats["wall_ms"].as_f64().expect("a time");
    assert!((sum - wall).abs() < 1e-6 * wall.max(1.0), "{sum} {wall}");
    // A picture may need a map more than its depths do: each pass keeps its own time.
    let paint = [
        "--set",
        "scene.paint=exact",
        "--set",
        "scene.tracer=max-mip",
    ];
    let output = folder.done(&tiny("terrain", &[&args[..], &paint].concat()));
    let stats: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let passes = stats["passes"].as_array().expect("a list");
    let named = |p: &&Value, name: &str| p["name"].as_str().is_some_and(|n| n.starts_with(name));
    assert_eq!(passes.iter().filter(|p| named(p, "prepare")).count(), 1);
    let marched = passes
        .iter()
        .filter(|p| named(p, "march") || named(p, "trace"));
    let sum: f64 = marched.filter_map(|p| p["wall_ms"].as_f64()).sum();
    let wall = stats["wall_ms"].as_f64().expect("a time");
    assert!((sum - wall).abs() < 1e-6 * wall.max(1.0), "{sum} {wall}");
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let folder = Folder::new();
    for size in ["0x5", "5x0", "abc", "99999x1", "64", "-1x5", ""] {
        let args = [
            "render",
            "mandelbox",
            "--device",
            "cpu",
            &format!("--size={size}"),
        ];
        folder.fails(&args, 2, &["--size", "like 1280x720"]);
    }
    let cases: [(&[&str], &[&str]); 15] = [
        (
            &["--layer", "colour"],
            &["--layer", "possible values: color, depth"],
        ),
        (&["--depth", "12"], &["--depth", "8, 16"]),
        (&["-o", "a.jpg"], &["`a.jpg`", ".png", ".exr"]),
        (&["-o", "a"], &["`a`", ".png", ".exr"]),
        (&["-o", "a.exr", "--depth", "16"], &["EXR", "--depth"]),
        (&["-o", "a.exr", "--layer", "depth"], &["EXR", "--layer"]),
        (&["-o", "-", "--stats", "-"], &["--stats"]),
        (&["-o", "a.png", "--stats", "a.png"], &["--stats"]),
        (
            &["--set", "camera.fov=400"],
            &["--set camera.fov=400: must be a number from 1 to 170"],
        ),
        (&["--set", "camera.fov=nan"], &["--set camera.fov=nan"]),
        (&["--set", "camera.fow=40"], &["unknown key", "`fov`"]),
        (&["--set", "cam.fov=40"], &["unknown section `cam`"]),
        (&["--set", "camera.fov"], &["no `=`", "camera.fov=30"]),
        (
            &["--set", "camera.eye=[0,0,0]"],
            &["--set camera.eye=[0,0,0]", "same point"],
        ),
        (
            &["--set", "scene.formula=mandelbx"],
            &["perhaps \"mandelbox\""],
        ),
    ];
    for (more, words) in cases {
        folder.fails(&tiny("mandelbox", more), 2, words);
    }
    folder.fails(
        &tiny("mandlebox", &[]),
        2,
        &[
            "`mandlebox`",
            "perhaps `mandelbox`",
            "bench-far, ",
            "terrain",
        ],
    );
    folder.fails(&tiny("", &[]), 2, &["no preset is called ``"]);
    folder.fails(&tiny("-", &[]), 2, &["no preset is called `-`"]);
}

#[test]
fn failures_are_exit_code_1() {
    let folder = Folder::new();
    folder.write("empty.toml", "");
    folder.write("binary.toml", [0xFF, 0xFE, 0x00, 0x80]);
    folder.write("large.toml", vec![b'#'; 1 << 21]);
    folder.write(
        "broken.toml",
        "[scene]\nkind = \"slab\"\n\n[camera]\nfov = 400\n",
    );
    folder.write("syntax.toml", "[scene]\nkind = \n");
    folder.write("not.png", b"\x89PNG\r\n\x1a\nnonsense");
    folder.write("foreign.png", foreign_png());
    fs::create_dir(folder.0.join("folder.toml")).expect("a folder");
    fs::create_dir(folder.0.join("folder.png")).expect("a folder");
    let cases: [(&str, &[&str]); 9] = [
        ("empty.toml", &["empty.toml: scene.kind is missing"]),
        ("binary.toml", &["binary.toml: is not text in UTF-8"]),
        ("large.toml", &["large.toml: is larger than 1 MiB"]),
        (
            "broken.toml",
            &["broken.toml:5: camera.fov = 400: must be a number from 1 to 170"],
        ),
        ("syntax.toml", &["syntax.toml:2: this is not TOML"]),
        ("not.png", &["not.png: is a broken PNG"]),
        ("foreign.png", &["foreign.png: carries no preset"]),
        ("folder.toml", &["folder.toml: is a folder"]),
        ("missing.toml", &["missing.toml: cannot be read"]),
    ];
    for (preset, words) in cases {
        folder.fails(&tiny(preset, &[]), 1, words);
    }
    folder.fails(
        &tiny("mandelbox", &["-o", "no/a.png"]),
        1,
        &["no/a.png", "no folder `no`"],
    );
    folder.fails(
        &tiny("mandelbox", &["-o", "empty.toml/a.png"]),
        1,
        &["empty.toml/a.png"],
    );
    folder.fails(
        &tiny("mandelbox", &["-o", "folder.png"]),
        1,
        &["folder.png: is a folder"],
    );
    folder.fails(
        &tiny("mandelbox", &["--stats", "no/s.json"]),
        1,
        &["no/s.json"],
    );
    let nobody = ["render", "mandelbox", "--size", "8x8", "--device"];
    for device in ["99", "no such adapter"] {
        let args = [&nobody[..], &[device]].concat();
        folder.fails(&args, 1, &["there is no adapter", device, "cpu"]);
    }
}

/// A picture that another program wrote.
fn foreign_png() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&[7]).expect("a pixel");
    writer.finish().expect("an end");
    bytes
}

#[cfg(target_os = "linux")]
#[test]
fn a_picture_that_does_not_fit_into_memory_is_refused_with_one_that_does() {
    let folder = Folder::new();
    let args = [
        "render",
        "mandelbox",
        "--device",
        "cpu",
        "--size",
        "65536x65536",
    ];
    folder.fails(&args, 1, &["65536x65536", " bytes of memory", "--size "]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_picture_that_finds_a_full_disk_says_which() {
    let folder = Folder::new();
    std::os::unix::fs::symlink("/dev/full", folder.0.join("full.png")).expect("a link");
    let words = ["full.png", "No space left", "elsewhere"];
    folder.fails(&tiny("mandelbox", &["-o", "full.png"]), 1, &words);
}

#[cfg(target_os = "linux")]
#[test]
fn nobody_need_listen_to_standard_error() {
    let folder = Folder::new();
    let deaf = |args: &[&str]| {
        let full = fs::OpenOptions::new().write(true).open("/dev/full");
        let mut command = folder.command(args);
        let status = command
            .stderr(full.expect("/dev/full"))
            .stdout(Stdio::null());
        status.status().expect("the program starts").code()
    };
    assert_eq!(deaf(&tiny("mandelbox", &["-o", "a.png"])), Some(0));
    assert_eq!(folder.files(), ["a.png"]);
    assert_eq!(deaf(&tiny("nothing", &[])), Some(2));
    assert_eq!(deaf(&["render"]), Some(2));
    assert_eq!(deaf(&tiny("mandelbox", &["-o", "no/a.png"])), Some(1));
}

#[test]
fn shares_are_of_what_is_in_the_picture() {
    let folder = Folder::new();
    let few = ["--set", "march.steps=2", "--stats", "s.json", "-o", "a.png"];
    folder.done(&tiny("mandelbox", &few));
    let stats: Value = serde_json::from_slice(&folder.bytes("s.json")).expect("JSON");
    let share = |name: &str| stats[name].as_f64().expect("a share");
    assert!(share("unconverged") > 0.0, "{stats}");
    let all = share("hit") + share("sky") + share("unconverged");
    assert!((all - 1.0).abs() < 1e-12, "{stats}");
}

#[test]
fn errors_are_a_layer() {
    let folder = Folder::new();
    let deep = [
        "--layer",
        "error",
        "-o",
        "a.png",
        "--set",
        "march.mode=slides-fast",
    ];
    folder.done(&tiny("bench-thin", &deep));
    folder.done(&tiny(
        "bench-thin",
        &[
            "--layer",
            "error",
            "-o",
            "b.png",
            "--set",
            "march.mode=truth",
        ],
    ));
    let [wrong, right] = ["a.png", "b.png"].map(|name| decode(&folder.bytes(name)).pixels);
    // Nothing of the truth is too deep; red says that much of the slides' picture is.
    let red = |p: &[u8]| {
        p.chunks(3)
            .filter(|c| c[0] > c[2].saturating_add(150))
            .count()
    };
    assert_eq!(red(&right), 0);
    assert!(red(&wrong) > 10, "{}", red(&wrong));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_and_leaves_nothing() {
    let folder = Folder::new();
    folder.fails(
        &tiny("mandelbox", &["-o", "a.png", "--stats", "/dev/full"]),
        1,
        &["/dev/full: cannot be written"],
    );
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("/dev/full");
    let mut command = folder.command(&["presets"]);
    let output = command.stdout(full).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).starts_with("error: standard output cannot be written"));
}

#[test]
fn a_reader_that_stops_is_no_error() {
    let folder = Folder::new();
    let mut command = folder.command(&["completions", "zsh"]);
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("an end");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(output.stderr.is_empty());
}

#[test]
fn an_existing_picture_is_replaced_only_by_a_whole_one() {
    let folder = Folder::new();
    folder.write("a.png", "precious");
    folder.fails(
        &tiny("mandelbox", &["-o", "a.png", "--device", "99"])
            .into_iter()
            .filter(|a| *a != "cpu")
            .collect::<Vec<_>>(),
        2,
        &["--device"],
    );
    folder.fails(
        &[
            "render",
            "mandelbox",
            "--size",
            "8x8",
            "-o",
            "a.png",
            "--device",
            "99",
        ],
        1,
        &["99"],
    );
    assert_eq!(folder.bytes("a.png"), b"precious");
    folder.done(&tiny("mandelbox", &["-o", "a.png"]));
    assert_eq!(decode(&folder.bytes("a.png")).info.width, 24);
    assert_eq!(folder.files(), ["a.png"]);
}

/// A render that runs far longer than a test may, interrupted once it has begun.
#[cfg(unix)]
fn interrupted(signals: u32) -> (Output, Vec<String>) {
    let folder = Folder::new();
    let mut command = folder.command(&[
        "render",
        "mandelbox",
        "--device",
        "cpu",
        "--size",
        "3000x3000",
        "--set",
        "march.mode=truth",
        "-o",
        "a.png",
        "--stats",
        "s.json",
    ]);
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let start = Instant::now();
    while folder.files().len() < 2 {
        assert!(start.elapsed() < Duration::from_secs(20), "it never began");
        sleep(Duration::from_millis(5));
    }
    sleep(Duration::from_millis(100));
    for _ in 0..signals {
        interrupt(child.id());
        sleep(Duration::from_millis(50));
    }
    while child.try_wait().expect("a child").is_none() {
        if start.elapsed() > Duration::from_secs(25) {
            let _ = child.kill();
            panic!("the interrupt was ignored");
        }
        sleep(Duration::from_millis(5));
    }
    let mut stderr = Vec::new();
    let mut pipe = child.stderr.take().expect("a pipe");
    pipe.read_to_end(&mut stderr).expect("what it said");
    let output = Output {
        status: child.wait().expect("an end"),
        stdout: Vec::new(),
        stderr,
    };
    (output, folder.files())
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_file() {
    for signals in [1, 2] {
        let (output, files) = interrupted(signals);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert_eq!(
            said.lines().last(),
            Some("error: cancelled; nothing was written")
        );
        assert!(files.is_empty(), "{files:?}");
    }
}

#[test]
fn an_eye_inside_the_solid_is_told() {
    const WORDS: &str = "camera.eye lies inside the solid";
    let folder = Folder::new();
    for preset in ["mandelbox", "terrain"] {
        let inside = ["--set", "camera.eye=[0.1,0.2,0.1]", "-o", "a.png"];
        assert!(said(&folder.done(&tiny(preset, &inside))).contains(WORDS));
        let outside = folder.done(&tiny(preset, &["-o", "b.png"]));
        assert!(!said(&outside).contains(WORDS), "{}", said(&outside));
    }
}
