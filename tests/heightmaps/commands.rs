//! `conemarch conemap`: what it makes, tells and draws. Maps are small and made by the CPU, so
//! that no adapter is needed.

use std::fs;
use std::process::Output;

use conemarch::heightfield::conemap::MapKind;
use conemarch::heightfield::conemap::file::{Layout, MapFile, RatioScale, Slopes, read_map};
use conemarch::heightfield::conemap::generate::generator::{Generator, Quality};
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::load::{LoadOptions, load};
use conemarch::heightfield::pattern::Pattern;
use conemarch::raster::png::BitDepth as Bits;
use png::{BitDepth, ColorType};

use crate::fields::plain;
use crate::folder::{Folder, holds, output, said, text};
use crate::pictures::{grey, pixels, png, raw, wide};

/// Makes a map on the CPU.
pub fn make(folder: &Folder, line: &str) -> Output {
    folder.done(&format!("conemap make {line} --device cpu"))
}

/// What `inspect` tells.
fn inspect(folder: &Folder, line: &str) -> String {
    text(&folder.done(&format!("conemap inspect {line}")))
}

fn read(folder: &Folder, name: &str) -> MapFile {
    read_map(&folder.0.join(name)).expect(name)
}

/// A PNG of a slope that ends in a wall, 16 bits.
pub fn slope() -> Vec<u8> {
    let at = |i: u16| match i % 16 {
        x @ 0..=12 => x * 1000 + i / 16,
        _ => 60_000,
    };
    let samples: Vec<u16> = (0..16 * 12).map(at).collect();
    let (color, bits) = (ColorType::Grayscale, BitDepth::Sixteen);
    png([16, 12], color, bits, &wide(&samples))
}

/// A folder with a height map in `rock.png`.
pub fn with_rock() -> Folder {
    let folder = Folder::new();
    folder.write("rock.png", slope());
    folder
}

/// A small render on the CPU of a preset with some values set.
pub fn render(sets: &str) -> String {
    let sets = sets.replace(' ', " --set ");
    format!("render terrain --size 12x9 --device cpu --set {sets}")
}

/// The notes that a command said.
fn notes(output: &Output) -> Vec<String> {
    let said = said(output);
    let notes = said.lines().filter(|l| l.starts_with("note: "));
    notes.map(str::to_string).collect()
}

#[test]
fn help_lists_verbs_generators_and_layouts() {
    let folder = Folder::new();
    let help = text(&folder.done("conemap --help"));
    holds(&help, &["make", "inspect", "convert"]);
    let help = text(&folder.done("conemap make --help"));
    holds(&help, &["--wrap", "--invert", "[default: exact]"]);
    let layouts = Layout::ALL.into_iter().filter(|l| *l != Layout::Full);
    holds(&help, &layouts.map(Layout::name).collect::<Vec<_>>());
    holds(&help, &Generator::ALL.map(Generator::name));
    holds(&help, &Pattern::ALL.map(Pattern::name));
}

#[test]
fn a_map_is_what_its_generator_makes_of_the_heights() {
    let folder = with_rock();
    let said = said(&make(&folder, "rock.png --wrap x"));
    assert_eq!(folder.files(), ["rock-cones.exr", "rock.png"]);
    assert!(said.starts_with("making cones on the CPU"), "{said}");
    let summary = said.lines().last().unwrap_or_default();
    let start = "rock-cones.exr  16 x 12  samples by exact";
    assert!(summary.starts_with(start), "{said}");
    let is_plain = !said.contains('\r') && !said.contains('\x1b');
    assert!(is_plain, "no bar off a terminal");
    let options = LoadOptions {
        wrap: [true, false],
        ..LoadOptions::default()
    };
    let loaded = load(folder.0.join("rock.png"), &options, &mut |_| true);
    let heights = loaded.expect("heights").heights;
    let map = plain(Generator::Exact, &heights);
    let made = read(&folder, "rock-cones.exr");
    assert_eq!(made.map.kind, MapKind::Samples);
    assert_eq!(made.map.wrap, [true, false]);
    assert_eq!(made.label.generator.as_deref(), Some("exact"));
    assert_eq!(made.heights.as_deref(), Some(heights.data()));
    for (after, before) in made.map.ratios.iter().zip(&map.ratios) {
        let kept = after <= before && *after >= before * 0.999_999;
        assert!(kept, "{after} {before}");
    }
    // Turned over it is another map.
    make(&folder, "rock.png --invert -o turned.exr");
    let turned = read(&folder, "turned.exr");
    assert_ne!(turned.label.digest, made.label.digest);
    assert_eq!(turned.heights.expect("heights")[0], 1.0 - heights.data()[0]);
}

/// Whether no cone of a map is wider than on another one.
fn no_wider(map: &MapFile, than: &MapFile) -> bool {
    let mut pairs = map.map.ratios.iter().zip(&than.map.ratios);
    pairs.all(|(after, before)| after <= before)
}

#[test]
fn every_generator_and_layout_goes_through_every_verb() {
    let folder = Folder::new();
    for generator in Generator::ALL {
        let name = generator.name();
        for file in ["a.exr", "a.png"] {
            make(&folder, &format!("fbm:12x9 --generator {name} -o {file}"));
            let told = inspect(&folder, &format!("{file} -o drawn.png"));
            assert!(told.contains(name), "{told}");
            // A generator whose cones may be too wide is described so.
            let flawed = matches!(generator.facts().quality, Quality::Flawed(_));
            assert_eq!(told.contains("too wide"), flawed, "{told}");
            assert!(told.lines().all(|l| l == l.trim_end()), "{told}");
            assert!(folder.bytes("drawn.png").starts_with(b"\x89PNG"));
        }
        let (exact, small) = (read(&folder, "a.exr"), read(&folder, "a.png"));
        let layout = small.format.layout;
        assert_eq!(layout, generator.kind().facts().layout, "{name}");
        for layout in Layout::ALL.into_iter().filter(|l| *l != Layout::Full) {
            let word = layout.name();
            let line = format!("conemap convert a.exr -o b.png --layout {word}");
            if let Some(why) = layout.lacks(generator.kind()) {
                folder.fails(&line, 2, &format!("{word}|{why}"));
                continue;
            }
            folder.done(&line);
            let there = read(&folder, "b.png");
            assert_eq!(there.format.layout, layout);
            assert_eq!(there.label, exact.label);
            folder.done("conemap convert b.png -o back.exr");
            assert!(no_wider(&there, &exact) && no_wider(&read(&folder, "back.exr"), &there));
            fs::remove_file(folder.0.join("b.png")).expect("a file");
        }
    }
}

#[test]
fn options_reach_the_file() {
    let folder = Folder::new();
    let make = |line: &str| make(&folder, &format!("sine:8x8 {line}"));
    make("--layout pair --bits 8 --ratio linear -o a.png");
    let format = read(&folder, "a.png").format;
    let found = (format.layout, format.bits, format.ratio);
    assert_eq!(found, (Layout::Pair, Bits::Eight, RatioScale::Linear));
    make("--generator walk --offset 1.5 --boxes -o w.exr");
    let file = read(&folder, "w.exr");
    assert_eq!((file.map.offset, file.map.size), (1.5, [8, 8]));
    assert_eq!(file.label.patches, Patches::Boxes);
    make("--generator relaxed-search --search-steps 9 --least-of-nine -o s.exr");
    let by = read(&folder, "s.exr").label.generator.unwrap_or_default();
    assert_eq!(by, "relaxed-search, 9 steps, least of nine");
    // Standard output gets the bytes that a file would.
    let piped = make("-o -");
    make("-o b.png");
    assert_eq!(piped.stdout, folder.bytes("b.png"));
    // The normals of deeper heights lean farther.
    for depth in ["0.1", "1"] {
        make(&format!("--layout relief --depth {depth} -o n{depth}.png"));
    }
    let lean = |name| {
        let shares = &read(&folder, name).shading[0].shares;
        shares.iter().fold(0.0, |m: f32, s| m.max(*s))
    };
    assert!(lean("n0.1.png") < lean("n1.png"));
    // The file says what its slopes mean.
    for slopes in Slopes::ALL {
        let word = slopes.name();
        make(&format!("--slopes {word} -o {word}.png"));
        let name = format!("{word}.png");
        assert_eq!(read(&folder, &name).format.slopes, slopes);
        let told = inspect(&folder, &name);
        let halved = told.contains("half slopes");
        assert_eq!(halved, slopes == Slopes::Half, "{told}");
    }
    assert!(lean("half.png") < lean("whole.png"));
}

#[test]
fn a_device_writes_the_files_that_the_cpu_writes() {
    let folder = Folder::new();
    for layout in ["dummer", "relief"] {
        let written = ["cpu", "0"].map(|device| {
            let into = format!("--layout {layout} --bits 16 --device {device} -o -");
            let line = format!("conemap make fbm:150x70 --wrap x {into}");
            folder.done(&line).stdout
        });
        assert_eq!(written[0], written[1], "{layout}");
    }
}

#[test]
fn inspect_tells_what_there_is() {
    let folder = Folder::new();
    let steps = [0.0, 0.0, 0.0, 1.0].repeat(2);
    folder.write("steps-4x2.raw", raw(&steps));
    make(&folder, "steps-4x2.raw -o m.exr");
    // Ratios 3, 2, 1 and two without bounds, twice; the width is 4.
    let of_map = [
        "m.exr\n",
        "4 x 2, kind samples",
        "4 x 2 samples, wrap none, SHA-256 ",
        "made by   exact",
        "EXR, 32-bit floats, 1 means 4 texels",
        "from 1 to 65536; 0 % are 0, 25.0 % are 4 or wider",
        "       1 to 2   25.0 %  ████████",
        "       2 to 4   50.0 %  ████████",
    ];
    holds(&inspect(&folder, "m.exr"), &of_map);
    let told = inspect(&folder, "steps-4x2.raw");
    holds(&told, &["4 x 2 samples", "mean 0.25", "raw, 32-bit floats"]);
    holds(&told, &["0.0 to 0.1   75.0 %"]);
}

#[test]
fn a_map_of_other_heights_is_refused() {
    let folder = with_rock();
    make(&folder, "rock.png --wrap xy -o m.png");
    let inspect = "conemap inspect m.png --heights";
    let output = folder.done(&format!("{inspect} rock.png --wrap xy"));
    holds(&said(&output), &["m.png belongs to rock.png"]);
    let wraps = "wrap along xy|wrap along none|--wrap none";
    let others = "m.png|other heights|--invert";
    for (heights, telling) in [
        ("rock.png", wraps),
        ("rock.png --wrap xy --invert", others),
        ("fbm:16x12 --wrap xy", "other heights"),
        ("fbm:8x8 --wrap xy", "16 x 12|8 x 8"),
    ] {
        folder.fails(&format!("{inspect} {heights}"), 1, telling);
    }
}

#[test]
fn a_map_serves_as_heights_wherever_heights_are_asked_for() {
    let folder = with_rock();
    make(&folder, "rock.png --generator relaxed-exact -o rel.png");
    let held = read(&folder, "rel.png").heights.expect("heights");
    let output = make(&folder, "rel.png -o again.exr");
    assert_eq!(read(&folder, "again.exr").heights.as_ref(), Some(&held));
    let [note] = &notes(&output)[..] else {
        panic!("one note: {}", said(&output));
    };
    assert!(note.contains("rel.png is a cone map") && note.contains("alpha"));
    // The same heights as a grey picture are the same block.
    let numbers: Vec<u8> = held.iter().map(|z| (z * 255.0).round() as u8).collect();
    folder.write("grey.png", grey([16, 12], &numbers));
    let depth = |field: &str| {
        let line = render(&format!("scene.field={field}"));
        let output = folder.done(&format!("{line} --layer depth -o depth.png"));
        (pixels(folder.bytes("depth.png")).1, notes(&output))
    };
    let (by_map, told) = depth("rel.png");
    let (by_grey, silent) = depth("grey.png");
    assert_eq!(by_map, by_grey);
    assert_eq!((told, silent), (vec![note.clone()], vec![]));
    let red = png([2, 1], ColorType::Rgb, BitDepth::Eight, &[9, 8, 7, 6, 5, 4]);
    folder.write("red.png", red);
    let (_, told) = depth("red.png");
    let red = "note: red.png has colours: red is taken as the height";
    assert_eq!(told, [red]);
    make(&folder, "rock.png --generator quad -o quad.png");
    let again = "conemap make quad.png --device cpu";
    folder.fails(again, 1, "quad.png|no heights");
    let again = render("scene.field=quad.png");
    folder.fails(&again, 2, "scene.field=quad.png|holds no heights");
}

#[test]
fn a_map_is_traced_over_the_heights_in_its_own_file() {
    let folder = with_rock();
    for (layout, picture) in [("dummer", "a.png"), ("pair", "b.png"), ("relief", "c.png")] {
        let line = format!("rock.png --layout {layout} --bits 8 -o m.png");
        make(&folder, &line);
        let output = folder.done("conemap inspect m.png --heights m.png");
        assert!(said(&output).contains("m.png belongs to m.png"));
        let line = render("scene.field=m.png scene.map=m.png scene.tracer=csm-exact");
        folder.done(&format!("{line} -o {picture}"));
        // Its numbers as heights turned over are others.
        let turned = format!("{line} --set scene.invert=true");
        folder.fails(&turned, 2, "m.png|other heights");
    }
}

#[test]
fn a_note_tells_that_a_map_does_not_say_its_heights() {
    let folder = Folder::new();
    let four = png([4, 4], ColorType::Rgba, BitDepth::Eight, &[9; 4 * 16]);
    folder.write("theirs.png", &four);
    let told = |line: &str, name: &str| {
        let output = folder.done(line);
        let notes = notes(&output);
        assert_eq!(notes.len(), 1, "{notes:?}");
        let start = format!("note: {name} does not tell what heights it was made for");
        assert!(notes[0].starts_with(&start), "{notes:?}");
        said(&output)
    };
    for verb in ["convert -o q.exr", "inspect"] {
        let line = format!("conemap {verb} theirs.png --from quad");
        told(&line, "theirs.png");
    }
    let said = told("conemap inspect q.exr --heights fbm:4x4", "q.exr");
    assert!(said.contains("q.exr may belong to fbm:4x4"), "{said}");
    let sets = |field| render(&format!("{field} scene.map=q.exr scene.tracer=quad"));
    told(&sets("scene.field=fbm:4x4"), "q.exr");
    folder.fails(&sets("scene.field=fbm:5x4"), 2, "4 x 4|5 x 4");
    // Heights in a file tell enough, and a label tells everything.
    make(&folder, "fbm:4x4 --generator quad -o ours.png");
    for line in ["theirs.png --from dummer", "ours.png"] {
        let output = folder.done(&format!("conemap inspect {line}"));
        assert_eq!(notes(&output), [""; 0]);
    }
}

#[test]
fn small_and_even_heights_have_maps() {
    let folder = Folder::new();
    for size in [[1u32, 1], [1, 7], [7, 1], [2, 2]] {
        let places = (size[0] * size[1]) as usize;
        folder.write("even.png", grey(size, &vec![90; places]));
        for generator in Generator::ALL.map(Generator::name) {
            for (wrap, file) in [("none", "m.exr"), ("xy", "m.png")] {
                let line = format!("even.png --generator {generator} --wrap {wrap} -o {file}");
                make(&folder, &line);
                inspect(&folder, &format!("{file} -o drawn.png"));
            }
        }
    }
}

#[cfg(unix)]
#[test]
fn names_need_not_be_utf_8() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    let name = |ending: &str| {
        let bytes = [b"r\xE4tsel".as_slice(), ending.as_bytes()].concat();
        OsStr::from_bytes(&bytes).to_os_string()
    };
    fs::write(folder.0.join(name(".png")), slope()).expect("a file");
    let run = |verb: &str, input: &str, more: &str, to: Option<&str>| {
        let mut command = folder.command(&format!("conemap {verb} {more}"));
        command.arg(name(input));
        if let Some(to) = to {
            command.arg("-o").arg(name(to));
        }
        let output = output(&mut command);
        assert!(output.status.success(), "{verb}: {}", said(&output));
    };
    run("make", ".png", "--device cpu", None);
    assert!(folder.0.join(name("-cones.exr")).exists());
    run("make", ".png", "--device cpu", Some(".exr"));
    run("convert", ".exr", "", Some("-b.png"));
    run("inspect", "-b.png", "", Some("-c.png"));
    let mut command = folder.command("conemap inspect");
    command.arg(name(".exr")).arg("--heights").arg(name(".png"));
    holds(&said(&output(&mut command)), &["belongs to"]);
}
