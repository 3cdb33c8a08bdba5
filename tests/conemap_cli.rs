//! `conemarch conemap`: what it makes, tells and draws, and a sentence for everything
//! that is wrong. Maps are small and made by the CPU, so that no adapter is needed.

use std::fs;

use conemarch::heightfield::conemap::MapKind;
use conemarch::heightfield::conemap::file::{Bits, Layout, MapFile, Slopes, read_map};
use conemarch::heightfield::conemap::generate::cpu;
use conemarch::heightfield::conemap::generate::generator::{Generator, Options};
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::load::{LoadOptions, load};
use conemarch::heightfield::pattern::Pattern;
use exr::prelude::FlatSamples;
use png::{BitDepth, ColorType};

#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod folder;
    pub mod pictures;
}
use common::folder::{Folder, said, text};
use common::pictures::{exr, png, raw, wide};

/// Arguments of a verb on the CPU.
fn make<'a>(heights: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["conemap", "make", heights, "--device", "cpu"];
    args.extend(more);
    args
}

fn inspect<'a>(file: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["conemap", "inspect", file];
    args.extend(more);
    args
}

fn read(folder: &Folder, name: &str) -> MapFile {
    read_map(&folder.0.join(name)).expect(name)
}

/// A PNG of a slope that ends in a wall, 16 bits.
fn slope() -> Vec<u8> {
    let at = |i: u16| {
        if i % 16 > 12 {
            60_000
        } else {
            i % 16 * 1000 + i / 16
        }
    };
    let samples: Vec<u16> = (0..16 * 12).map(at).collect();
    png(
        [16, 12],
        ColorType::Grayscale,
        BitDepth::Sixteen,
        &wide(&samples),
    )
}

#[test]
fn help_lists_verbs_generators_and_layouts() {
    let folder = Folder::new();
    let help = text(&folder.done(&["conemap", "--help"]));
    for verb in ["make", "inspect", "convert"] {
        assert!(help.contains(verb), "{help}");
    }
    let help = text(&folder.done(&["conemap", "make", "--help"]));
    for word in Generator::ALL.map(Generator::name) {
        assert!(help.contains(word), "{word}: {help}");
    }
    for word in [
        "dummer",
        "relief",
        "pair",
        "quad",
        "--wrap",
        "--invert",
        "[default: exact]",
    ] {
        assert!(help.contains(word), "{word}: {help}");
    }
    for word in Pattern::ALL.map(Pattern::name) {
        assert!(help.contains(word), "{word}: {help}");
    }
    folder.fails(&["conemap"], 2, &["a command is missing"]);
    let unknown = make("fbm:4x4", &["--generator", "quick"]);
    let names = Generator::ALL.map(Generator::name).join(", ");
    folder.fails(&unknown, 2, &["quick", &names]);
}

#[test]
fn a_map_is_what_its_generator_makes_of_the_heights() {
    let folder = Folder::new();
    folder.write("rock.png", slope());
    let output = folder.done(&make("rock.png", &["--wrap", "x"]));
    assert_eq!(folder.files(), ["rock-cones.exr", "rock.png"]);
    let said = said(&output);
    assert!(said.starts_with("making cones on the CPU"), "{said}");
    let summary = said.lines().last().unwrap_or_default();
    assert!(
        summary.starts_with("rock-cones.exr  16 x 12  samples by exact"),
        "{said}"
    );
    assert!(
        !said.contains('\r') && !said.contains('\x1b'),
        "no bar off a terminal"
    );
    let options = LoadOptions {
        wrap: [true, false],
        ..LoadOptions::default()
    };
    let path = folder.0.join("rock.png").display().to_string();
    let heights = load(&path, &options).expect("heights").heights;
    let watch = &mut |_| true;
    let patches = Patches::Bilinear;
    let map = cpu::generate(
        Generator::Exact,
        &heights,
        patches,
        &Options::default(),
        watch,
    );
    let (map, made) = (map.expect("a map"), read(&folder, "rock-cones.exr"));
    assert_eq!(
        (made.map.kind, made.map.wrap),
        (MapKind::Samples, [true, false])
    );
    assert_eq!(made.label.generator.as_deref(), Some("exact"));
    assert_eq!(made.heights.as_deref(), Some(heights.data()));
    for (after, before) in made.map.ratios.iter().zip(&map.ratios) {
        assert!(
            after <= before && *after >= before * 0.999_999,
            "{after} {before}"
        );
    }
    // Turned over it is another map.
    let turned = make("rock.png", &["--invert", "-o", "turned.exr"]);
    folder.done(&turned);
    let turned = read(&folder, "turned.exr");
    assert_ne!(turned.label.digest, made.label.digest);
    assert_eq!(turned.heights.expect("heights")[0], 1.0 - heights.data()[0]);
}

#[test]
fn every_generator_and_layout_goes_through_every_verb() {
    let folder = Folder::new();
    for generator in Generator::ALL {
        let name = generator.name();
        folder.done(&make("fbm:12x9", &["--generator", name, "-o", "a.exr"]));
        folder.done(&make("fbm:12x9", &["--generator", name, "-o", "a.png"]));
        let (exact, small) = (read(&folder, "a.exr"), read(&folder, "a.png"));
        assert_eq!(small.form.layout, Layout::usual(generator.kind()), "{name}");
        for file in ["a.exr", "a.png"] {
            let told = text(&folder.done(&inspect(file, &["-o", "drawn.png"])));
            assert!(told.contains(name), "{told}");
            assert!(told.lines().all(|l| l == l.trim_end()), "{told}");
            assert!(folder.bytes("drawn.png").starts_with(b"\x89PNG"));
        }
        for layout in Layout::ALL.into_iter().filter(|l| *l != Layout::Full) {
            let into = ["convert", "a.exr", "-o", "b.png", "--layout", layout.name()];
            let args = [&["conemap"], &into[..]].concat();
            if let Some(why) = layout.lacks(generator.kind()) {
                folder.fails(&args, 2, &[layout.name(), why]);
                continue;
            }
            folder.done(&args);
            let there = read(&folder, "b.png");
            assert_eq!(there.form.layout, layout);
            assert_eq!(there.label, exact.label);
            let pairs = there.map.ratios.iter().zip(&exact.map.ratios);
            assert!(pairs.clone().all(|(after, before)| after <= before));
            folder.done(&["conemap", "convert", "b.png", "-o", "back.exr"]);
            let back = read(&folder, "back.exr");
            let pairs = back.map.ratios.iter().zip(&there.map.ratios);
            assert!(pairs.clone().all(|(after, before)| after <= before));
            fs::remove_file(folder.0.join("b.png")).expect("a file");
        }
    }
}

#[test]
fn options_reach_the_file() {
    let folder = Folder::new();
    let pair = [
        "--layout", "pair", "--bits", "8", "--ratio", "linear", "-o", "a.png",
    ];
    folder.done(&make("sine:8x8", &pair));
    let file = read(&folder, "a.png");
    let form = file.form;
    assert_eq!(
        (form.layout, form.bits, form.root),
        (Layout::Pair, Bits::Eight, false)
    );
    let walk = [
        "--generator",
        "walk",
        "--offset",
        "1.5",
        "--boxes",
        "-o",
        "w.exr",
    ];
    folder.done(&make("sine:8x8", &walk));
    let file = read(&folder, "w.exr");
    assert_eq!((file.map.offset, file.map.size), (1.5, [8, 8]));
    assert_eq!(file.label.patches, Patches::Boxes);
    let search = [
        "--generator",
        "relaxed-search",
        "--search-steps",
        "9",
        "--least-of-nine",
    ];
    folder.done(&make("sine:8x8", &[&search[..], &["-o", "s.exr"]].concat()));
    let by = read(&folder, "s.exr").label.generator.unwrap_or_default();
    assert_eq!(by, "relaxed-search, 9 steps, least of nine");
    // Standard output gets the bytes that a file would.
    let piped = folder.done(&make("sine:8x8", &["-o", "-"]));
    folder.done(&make("sine:8x8", &["-o", "b.png"]));
    assert_eq!(piped.stdout, folder.bytes("b.png"));
    // Deeper reliefs lean their normals farther.
    for depth in ["0.1", "1"] {
        let name = format!("n{depth}.png");
        folder.done(&make(
            "sine:8x8",
            &["--layout", "relief", "--depth", depth, "-o", &name],
        ));
    }
    let lean = |name| {
        read(&folder, name).extra[0]
            .shares
            .iter()
            .fold(0.0, |m: f32, s| m.max(*s))
    };
    assert!(lean("n0.1.png") < lean("n1.png"));
    // Slopes as one likes them, which the file says.
    for slopes in Slopes::ALL {
        let name = format!("{}.png", slopes.name());
        let into = ["--slopes", slopes.name(), "-o", &name];
        folder.done(&make("sine:8x8", &into));
        assert_eq!(read(&folder, &name).form.slopes, slopes);
        let told = text(&folder.done(&["conemap", "inspect", &name]));
        assert_eq!(
            told.contains("half slopes"),
            slopes == Slopes::Half,
            "{told}"
        );
    }
    assert!(lean("half.png") < lean("whole.png"));
}

#[test]
fn a_device_writes_the_files_that_the_cpu_writes() {
    let folder = Folder::new();
    for layout in ["dummer", "relief"] {
        let written = ["cpu", "0"].map(|device| {
            let make = ["conemap", "make", "fbm:150x70", "--wrap", "x", "-o", "-"];
            let into = ["--layout", layout, "--bits", "16", "--device", device];
            folder.done(&[&make[..], &into].concat()).stdout
        });
        assert_eq!(written[0], written[1], "{layout}");
    }
}

#[test]
fn inspect_tells_what_there_is() {
    let folder = Folder::new();
    let raw_name = "steps-4x2.raw";
    folder.write(raw_name, raw(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]));
    folder.done(&make(raw_name, &["-o", "m.exr"]));
    let told = text(&folder.done(&inspect("m.exr", &[])));
    // Ratios 3, 2, 1 and two without bounds, twice; the width is 4.
    for words in [
        "m.exr\n",
        "4 x 2, kind samples",
        "4 x 2 samples, wrap none, SHA-256 ",
        "made by   exact",
        "EXR, 32-bit floats, 1 means 4 texels",
        "from 1 to 65536; 0 % are 0, 25.0 % are 4 or wider",
        "       1 to 2   25.0 %  ████████",
        "       2 to 4   50.0 %  ████████",
    ] {
        assert!(told.contains(words), "`{words}` not in:\n{told}");
    }
    let told = text(&folder.done(&inspect(raw_name, &[])));
    for words in [
        "4 x 2 samples",
        "mean 0.25",
        "0.0 to 0.1   75.0 %",
        "raw, 32-bit floats",
    ] {
        assert!(told.contains(words), "`{words}` not in:\n{told}");
    }
    // What promises nothing is told to do so.
    folder.done(&make(
        "noise:8x8",
        &["--generator", "center", "-o", "c.exr"],
    ));
    let told = text(&folder.done(&inspect("c.exr", &[])));
    assert!(told.contains("too wide"), "{told}");
}

#[test]
fn a_map_of_other_heights_is_refused() {
    let folder = Folder::new();
    folder.write("rock.png", slope());
    folder.done(&make("rock.png", &["--wrap", "xy", "-o", "m.png"]));
    let with = |more: &[&'static str]| [&inspect("m.png", &["--heights"])[..], more].concat();
    let output = folder.done(&with(&["rock.png", "--wrap", "xy"]));
    assert!(said(&output).contains("m.png belongs to rock.png"));
    let wraps = ["wrap along xy", "wrap along none", "--wrap none"];
    folder.fails(&with(&["rock.png"]), 1, &wraps);
    let turned = ["rock.png", "--wrap", "xy", "--invert"];
    folder.fails(&with(&turned), 1, &["m.png", "other heights", "--invert"]);
    folder.fails(&with(&["fbm:16x12", "--wrap", "xy"]), 1, &["other heights"]);
    folder.fails(
        &with(&["fbm:8x8", "--wrap", "xy"]),
        1,
        &["16 x 12", "8 x 8"],
    );
    folder.fails(
        &inspect("rock.png", &["--heights", "rock.png"]),
        2,
        &["no cone map"],
    );
}

/// A small render on the CPU of a preset with some values set.
fn render<'a>(sets: &[&'a str]) -> Vec<&'a str> {
    let mut args = vec!["render", "terrain", "--size", "12x9", "--device", "cpu"];
    args.extend(sets.iter().flat_map(|set| ["--set", set]));
    args
}

/// The notes that a command said.
fn notes(output: &std::process::Output) -> Vec<String> {
    let said = said(output);
    let notes = said.lines().filter(|l| l.starts_with("note: "));
    notes.map(str::to_string).collect()
}

#[test]
fn a_map_serves_as_heights_wherever_heights_are_asked_for() {
    let folder = Folder::new();
    folder.write("rock.png", slope());
    let relaxed = ["--generator", "relaxed-exact", "-o", "rel.png"];
    folder.done(&make("rock.png", &relaxed));
    let held = read(&folder, "rel.png").heights.expect("heights");
    let output = folder.done(&make("rel.png", &["-o", "again.exr"]));
    assert_eq!(read(&folder, "again.exr").heights, Some(held));
    let [note] = &notes(&output)[..] else {
        panic!("one note: {}", said(&output));
    };
    assert!(note.contains("rel.png is a cone map") && note.contains("alpha"));
    // The same heights as a grey picture are the same block.
    let held = read(&folder, "rel.png").heights.expect("heights");
    let grey: Vec<u8> = held.iter().map(|z| (z * 255.0).round() as u8).collect();
    let grey = png([16, 12], ColorType::Grayscale, BitDepth::Eight, &grey);
    folder.write("grey.png", grey);
    let depth = |field, picture| {
        let more = ["--layer", "depth", "-o", picture];
        let output = folder.done(&[&render(&[field])[..], &more].concat());
        let bytes = folder.bytes(picture);
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut pixels).expect("pixels");
        (pixels, notes(&output))
    };
    let (by_map, told) = depth("scene.field=rel.png", "map.png");
    let (by_grey, silent) = depth("scene.field=grey.png", "of-grey.png");
    assert_eq!(by_map, by_grey);
    assert_eq!((told, silent), (vec![note.clone()], vec![]));
    let red = png([2, 1], ColorType::Rgb, BitDepth::Eight, &[9, 8, 7, 6, 5, 4]);
    folder.write("red.png", red);
    let (_, told) = depth("scene.field=red.png", "of-red.png");
    let red = "note: red.png has colours: red is taken as the height";
    assert_eq!(told, [red]);
    folder.done(&make(
        "rock.png",
        &["--generator", "quad", "-o", "quad.png"],
    ));
    folder.fails(&make("quad.png", &[]), 1, &["quad.png", "no heights"]);
    let words = ["scene.field=quad.png", "holds no heights"];
    folder.fails(&render(&["scene.field=quad.png"]), 2, &words);
}

#[test]
fn a_map_is_traced_over_the_heights_in_its_own_file() {
    let folder = Folder::new();
    folder.write("rock.png", slope());
    let with = |layout, picture| {
        let map = ["--layout", layout, "--bits", "8", "-o", "m.png"];
        folder.done(&make("rock.png", &map));
        let output = folder.done(&inspect("m.png", &["--heights", "m.png"]));
        assert!(said(&output).contains("m.png belongs to m.png"));
        let sets = [
            "scene.field=m.png",
            "scene.map=m.png",
            "scene.tracer=csm-exact",
        ];
        folder.done(&[&render(&sets)[..], &["-o", picture]].concat());
        // Its numbers as heights turned over are others.
        let turned = [&render(&sets)[..], &["--set", "scene.invert=true"]].concat();
        folder.fails(&turned, 2, &["m.png", "other heights"]);
    };
    for (layout, picture) in [("dummer", "a.png"), ("pair", "b.png"), ("relief", "c.png")] {
        with(layout, picture);
    }
}

#[test]
fn a_map_never_takes_the_place_of_its_heights() {
    let folder = Folder::new();
    folder.write("rock.png", slope());
    let words = ["rock.png", "another name"];
    folder.fails(&make("rock.png", &["-o", "rock.png"]), 2, &words);
    folder.fails(&make("rock.png", &["-o", "./rock.png"]), 2, &words);
    folder.fails(&inspect("rock.png", &["-o", "rock.png"]), 2, &words);
    folder.done(&make("rock.png", &["-o", "m.png"]));
    let before = folder.bytes("m.png");
    let convert = ["conemap", "convert", "m.png", "-o", "m.png"];
    folder.fails(&convert, 2, &["m.png", "another name"]);
    assert_eq!(folder.bytes("m.png"), before);
    assert_eq!(folder.bytes("rock.png"), slope());
}

#[test]
fn ratios_that_nothing_tells_the_heights_of_are_told_of() {
    let folder = Folder::new();
    let quad = png([4, 4], ColorType::Rgba, BitDepth::Eight, &[9; 4 * 16]);
    folder.write("theirs.png", quad);
    let from = ["conemap", "convert", "theirs.png", "--from", "quad"];
    let told = |output, name: &str| {
        let notes = notes(&output);
        assert_eq!(notes.len(), 1, "{notes:?}");
        let start = format!("note: {name} does not tell what heights it was made for");
        assert!(notes[0].starts_with(&start), "{notes:?}");
        said(&output)
    };
    let output = folder.done(&[&from[..], &["-o", "q.exr"]].concat());
    told(output, "theirs.png");
    let output = folder.done(&inspect("theirs.png", &["--from", "quad"]));
    told(output, "theirs.png");
    let output = folder.done(&inspect("q.exr", &["--heights", "fbm:4x4"]));
    let said = told(output, "q.exr");
    assert!(said.contains("q.exr may belong to fbm:4x4"), "{said}");
    let sets = [
        "scene.field=fbm:4x4",
        "scene.map=q.exr",
        "scene.tracer=quad",
    ];
    told(folder.done(&render(&sets)), "q.exr");
    folder.fails(
        &render(&["scene.field=fbm:5x4", sets[1], sets[2]]),
        2,
        &["4 x 4", "5 x 4"],
    );
    // Heights in a file tell enough, and a label all.
    folder.write(
        "dummer.png",
        png([4, 4], ColorType::Rgba, BitDepth::Eight, &[9; 4 * 16]),
    );
    let dummer = inspect("dummer.png", &["--from", "dummer"]);
    assert_eq!(notes(&folder.done(&dummer)), [""; 0]);
    folder.done(&make("fbm:4x4", &["--generator", "quad", "-o", "ours.png"]));
    assert_eq!(notes(&folder.done(&inspect("ours.png", &[]))), [""; 0]);
}

#[test]
fn options_without_effect_are_wrong_usage() {
    let folder = Folder::new();
    folder.done(&make("sine:4x4", &["-o", "m.png"]));
    folder.done(&make("sine:4x4", &["-o", "m.exr"]));
    for file in ["m.png", "m.exr"] {
        let from = [
            "conemap", "convert", file, "-o", "a.exr", "--from", "relief",
        ];
        let words = [file, "--from", "leave it out"];
        folder.fails(&from, 2, &words);
        folder.fails(&inspect(file, &["--from", "dummer"]), 2, &words);
        for option in [
            &["--wrap", "x"][..],
            &["--invert"],
            &["--normalize"],
            &["--size", "4x4"],
        ] {
            let words = [file, option[0], "--heights"];
            folder.fails(&inspect(file, option), 2, &words);
        }
    }
    let quad = png([4, 4], ColorType::Rgba, BitDepth::Eight, &[9; 4 * 16]);
    folder.write("theirs.png", quad);
    let theirs = |more| [&inspect("theirs.png", &["--from", "dummer"])[..], more].concat();
    folder.done(&theirs(&["--wrap", "x"]));
    folder.fails(&theirs(&["--invert"]), 2, &["--invert", "--heights"]);
    for layout in ["dummer", "pair"] {
        let args = ["--layout", layout, "--depth", "3", "-o", "a.png"];
        let words = ["--depth", "relief", layout];
        folder.fails(&make("sine:4x4", &args), 2, &words);
    }
    let words = ["EXR", "--depth"];
    folder.fails(&make("sine:4x4", &["--depth", "3"]), 2, &words);
    let convert = ["conemap", "convert", "m.exr", "-o", "a.png", "--depth", "3"];
    folder.fails(&convert, 2, &["--depth", "relief", "dummer"]);
    for layout in ["pair", "relief"] {
        let args = ["--layout", layout, "--slopes", "half", "-o", "a.png"];
        folder.fails(&make("sine:4x4", &args), 2, &["--slopes", "dummer", layout]);
    }
    folder.fails(
        &make("sine:4x4", &["--slopes", "half"]),
        2,
        &["EXR", "--slopes"],
    );
}

#[test]
fn small_and_even_heights_have_maps() {
    let folder = Folder::new();
    for size in [[1u32, 1], [1, 7], [7, 1], [2, 2]] {
        let places = (size[0] * size[1]) as usize;
        let even = png(
            size,
            ColorType::Grayscale,
            BitDepth::Eight,
            &vec![90; places],
        );
        folder.write("even.png", even);
        for generator in Generator::ALL {
            for (wrap, file) in [("none", "m.exr"), ("xy", "m.png")] {
                let more = ["--generator", generator.name(), "--wrap", wrap, "-o", file];
                folder.done(&make("even.png", &more));
                folder.done(&inspect(file, &["-o", "drawn.png"]));
            }
        }
    }
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let folder = Folder::new();
    folder.done(&make("sine:4x4", &["-o", "m.exr"]));
    let cases: [(&[&str], &[&str]); 15] = [
        (&["--wrap", "z"], &["--wrap", "none, x, y, xy"]),
        (&["-o", "a.jpg"], &["`a.jpg`", ".png", ".exr"]),
        (&["-o", "a.exr", "--bits", "8"], &["EXR", "--bits"]),
        (&["-o", "a.exr", "--layout", "pair"], &["EXR", "--layout"]),
        (
            &["-o", "a.png", "--layout", "full"],
            &["dummer, relief, pair, quad"],
        ),
        (
            &["-o", "a.png", "--layout", "quad"],
            &["`quad`", "four ratios"],
        ),
        (&["-o", "a.png", "--bits", "12"], &["--bits", "8, 16"]),
        (&["--depth", "0"], &["--depth", "0.001 to 1000"]),
        (&["--offset", "2"], &["--offset", "walk", "exact"]),
        (&["--boxes"], &["--boxes", "walk"]),
        (
            &["--search-steps", "9"],
            &["--search-steps", "relaxed-search"],
        ),
        (
            &["--generator", "walk", "--offset", "0"],
            &["an offset of 0"],
        ),
        (
            &["--generator", "walk", "--offset", "nan"],
            &["an offset of NaN"],
        ),
        (&["--size", "4x4"], &["fbm:4x4", "--size"]),
        (&["--size", "9000x1"], &["--size", "8192"]),
    ];
    for (more, words) in cases {
        folder.fails(&make("fbm:4x4", more), 2, words);
    }
    folder.fails(
        &make("fmb:4x4", &[]),
        2,
        &["fmb:4x4", "fields are fbm, ridges"],
    );
    folder.fails(&make("fbm:4x4,seed=x", &[]), 2, &["seed=x"]);
    folder.fails(&inspect("nothing", &[]), 2, &["nothing", "fields are fbm"]);
    folder.fails(&inspect("m.exr", &["-o", "a.exr"]), 2, &["a.exr", ".png"]);
    folder.fails(&["conemap", "convert", "m.exr"], 2, &["-o MAP.png"]);
    folder.fails(
        &["conemap", "convert", "m.exr", "-o", "a.bmp"],
        2,
        &["a.bmp"],
    );
    let lonely = ["conemap", "convert", "m.exr", "-o", "a.png", "--wrap", "x"];
    folder.fails(&lonely, 2, &["--from"]);
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
    for (heights, words) in cases {
        folder.fails(&make(heights, &["-o", "m.exr"]), 1, words);
        folder.fails(&inspect(heights, &["-o", "m.png"]), 1, words);
    }
    folder.done(&make("metres.exr", &["--normalize", "-o", "m.exr"]));
    // Alpha is no height, and somebody is told.
    let alpha = wide(&[13107, 0, 65535, 65535]);
    folder.write(
        "ga.png",
        png([2, 1], ColorType::GrayscaleAlpha, BitDepth::Sixteen, &alpha),
    );
    let output = folder.done(&make("ga.png", &["-o", "m.exr"]));
    assert!(
        said(&output).contains("note: ga.png is transparent"),
        "{}",
        said(&output)
    );
}

#[test]
fn bad_maps_and_places_are_exit_code_1() {
    let folder = Folder::new();
    folder.write("rock.png", slope());
    folder.done(&make("rock.png", &["-o", "m.png"]));
    let map = folder.bytes("m.png");
    folder.write("cut.png", &map[..map.len() * 2 / 3]);
    folder.write("text.txt", "nothing");
    let convert = |file: &'static str, more: &[&'static str]| {
        [&["conemap", "convert", file, "-o", "b.exr"][..], more].concat()
    };
    folder.fails(
        &convert("rock.png", &[]),
        1,
        &["rock.png", "conemap make", "--from"],
    );
    folder.fails(
        &convert("cut.png", &[]),
        1,
        &["cut.png", "ends before its end"],
    );
    folder.fails(
        &inspect("cut.png", &[]),
        1,
        &["cut.png", "ends before its end"],
    );
    folder.fails(&convert("text.txt", &[]), 1, &["text.txt", "PNG or EXR"]);
    folder.fails(
        &convert("missing.png", &[]),
        1,
        &["missing.png: cannot be read"],
    );
    let as_map = ["--from", "dummer"];
    folder.fails(
        &convert("rock.png", &as_map),
        1,
        &["rock.png", "1 channels"],
    );
    for verb in [make("rock.png", &[]), convert("m.png", &[])] {
        let into = |path| {
            let mut args = verb.clone();
            args.retain(|a| *a != "-o" && *a != "b.exr");
            args.extend(["-o", path]);
            args
        };
        folder.fails(&into("no/b.exr"), 1, &["no/b.exr", "no folder `no`"]);
    }
    fs::create_dir(folder.0.join("folder.png")).expect("a folder");
    folder.fails(
        &make("rock.png", &["-o", "folder.png"]),
        1,
        &["is a folder"],
    );
    folder.fails(&inspect("m.png", &["-o", "no/a.png"]), 1, &["no/a.png"]);
    let nobody = ["conemap", "make", "sine:4x4", "--device", "99"];
    folder.fails(&nobody, 1, &["there is no adapter", "99", "cpu"]);
    // What was there stays, whatever fails.
    folder.write("old.exr", "precious");
    folder.fails(&make("cut.png", &["-o", "old.exr"]), 1, &["cut.png"]);
    assert_eq!(folder.bytes("old.exr"), b"precious");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let folder = Folder::new();
    std::os::unix::fs::symlink("/dev/full", folder.0.join("full.exr")).expect("a link");
    let words = ["full.exr", "No space left"];
    folder.fails(&make("sine:8x8", &["-o", "full.exr"]), 1, &words);
}
