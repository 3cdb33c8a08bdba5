//! Height maps from files: every format, and a sentence for everything that is wrong.

use conemarch::heightfield::FileError;
use conemarch::heightfield::conemap::file::{Layout, MapFile, MapFormat, decode_bytes, encode};
use conemarch::heightfield::conemap::generate::generator::{Generator, ShareWatch};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::load::{LoadOptions, Loaded, load};
use conemarch::heightfield::pattern::Pattern;
use conemarch::pass::prepare::FrameError;
use conemarch::pass::progress::Progress;
use conemarch::plan::Extras;
use conemarch::raster::png::BitDepth as Bits;
use conemarch::scene::{Assets, Scene};
use conemarch::{cpu, preset};
use exr::prelude::FlatSamples;
use png::{BitDepth, ColorType};
use tiff::encoder::colortype::{Gray8, Gray16, Gray32Float, GrayI16, RGB8};

use crate::fields::{make, plain};
use crate::folder::Folder;
use crate::pictures::{exr, grey, png, raw, tiff, wide};

/// Loads a file of a test's folder.
fn load_as(folder: &Folder, name: &str, options: &LoadOptions) -> Result<Loaded, String> {
    load(folder.0.join(name), options, &mut |_| true).map_err(|e| e.to_string())
}

/// The heights of a file, and its note.
fn loaded(folder: &Folder, name: &str) -> (Vec<f32>, String) {
    let Loaded { heights, note, .. } = load_as(folder, name, &LoadOptions::default()).expect(name);
    (heights.data().to_vec(), note.unwrap_or_default())
}

fn values(folder: &Folder, name: &str) -> Vec<f32> {
    loaded(folder, name).0
}

/// Checks that a file is refused in one sentence with its name and some words.
fn refused(folder: &Folder, name: &str, words: &[&str]) {
    refused_as(folder, name, &LoadOptions::default(), words);
}

fn refused_as(folder: &Folder, name: &str, options: &LoadOptions, words: &[&str]) {
    let why = load_as(folder, name, options).expect_err(name);
    assert!(why.contains(name), "{why}");
    assert!(!why.contains('\n'), "{why}");
    for word in words {
        assert!(why.contains(word), "`{word}` not in: {why}");
    }
}

/// Options with the size of a raw file.
fn sized(size: [u32; 2]) -> LoadOptions {
    LoadOptions {
        size: Some(size),
        ..LoadOptions::default()
    }
}

/// Options that scale heights to 0 to 1.
fn normalized() -> LoadOptions {
    LoadOptions {
        normalize: true,
        ..LoadOptions::default()
    }
}

/// Two samples as an EXR channel.
fn two(z: f32) -> FlatSamples {
    FlatSamples::F32(vec![z, 0.0])
}

#[test]
fn a_file_of_any_kind_is_read() {
    use ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba};
    let folder = Folder::new();
    let eight = BitDepth::Eight;
    let sixteen = |color, samples: &[u16]| png([2, 1], color, BitDepth::Sixteen, &wide(samples));
    let deep = sixteen(Grayscale, &[13107, 65535]);
    let half_seen = sixteen(GrayscaleAlpha, &[13107, 65535, 65535, 0]);
    let full = sixteen(GrayscaleAlpha, &[13107, 65535, 65535, 65535]);
    let rgba = sixteen(Rgba, &[13107, 13107, 13107, 7, 65535, 65535, 65535, 9]);
    let rgb = vec![("R", two(0.1)), ("G", two(0.2)), ("B", two(0.3))];
    let depth = vec![("A", two(0.5)), ("R", two(0.1)), ("depth.Z", two(0.7))];
    let named = vec![("Y", two(0.5)), ("height", two(0.25)), ("Z", two(0.7))];
    // Checks the heights of a file, and that a note has a word, or that there is no note.
    let check = |name: &str, bytes: Vec<u8>, heights: &[f32], word: &str| {
        folder.write(name, bytes);
        let (values, note) = loaded(&folder, name);
        assert_eq!(values, heights, "{name}");
        let right = note.contains(word) && note.is_empty() == word.is_empty();
        assert!(right, "{name}: {note}");
    };
    check("grey.png", grey([2, 1], &[0, 51]), &[0.0, 0.2], "");
    check("deep.png", deep, &[0.2, 1.0], "");
    // One bit, rows from the highest: white, black, white.
    let file = png([3, 1], Grayscale, BitDepth::One, &[0b1010_0000]);
    check("bit.png", file, &[1.0, 0.0, 1.0], "");
    let file = png([2, 1], Indexed, eight, &[1, 2]);
    check("palette.png", file, &[0.2, 1.0], "");
    let file = png([1, 2], Rgb, eight, &[51, 51, 51, 255, 255, 255]);
    check("even.png", file, &[0.2, 1.0], "");
    let file = png([1, 1], Rgb, eight, &[51, 0, 255]);
    check("red.png", file, &[0.2], "red");
    // Alpha is not a height, and full alpha needs no note.
    check("ga.png", half_seen, &[0.2, 1.0], "alpha");
    check("full.png", full, &[0.2, 1.0], "");
    check("rgba.png", rgba, &[0.2, 1.0], "alpha");
    // An EXR has its heights in the channel that says so.
    for (size, channels, height, word) in [
        ([2, 1], rgb, 0.1, "R is the height"),
        ([2, 1], depth, 0.7, "depth.Z is the height"),
        ([1, 2], named, 0.25, "height is the height"),
    ] {
        check("a.exr", exr(size, channels), &[height, 0.0], word);
    }
    let half = FlatSamples::F16(vec![exr::prelude::f16::from_f32(0.5); 2]);
    let half = exr([2, 1], vec![("lonely", half)]);
    check("half.exr", half, &[0.5, 0.5], "");
    check("8.tif", tiff::<Gray8>([2, 1], &[0, 51]), &[0.0, 0.2], "");
    let file = tiff::<Gray16>([2, 1], &[13107, 65535]);
    check("16.tif", file, &[0.2, 1.0], "");
    let file = tiff::<Gray32Float>([2, 1], &[0.2, 0.75]);
    check("float.tif", file, &[0.2, 0.75], "");
    let file = tiff::<RGB8>([2, 1], &[51, 1, 2, 255, 3, 4]);
    check("rgb.tif", file, &[0.2, 1.0], "first");
    // Heights within 0 to 1 stay as they are.
    check("a_dent_2X1.raw", raw(&[0.4, 0.5]), &[0.4, 0.5], "");
    let uv = vec![("U", two(0.5)), ("V", two(0.5))];
    folder.write("uv.exr", exr([2, 1], uv));
    refused(&folder, "uv.exr", &["channels U, V", "rename"]);
}

/// A generator's map of some heights.
fn map_of(heights: &Heights, generator: Generator, patches: Patches) -> MapFile {
    let map = make(generator, heights, patches, &Default::default());
    MapFile::new(map, heights, patches, generator.name())
}

#[test]
fn a_cone_map_has_its_heights_where_its_layout_has_them() {
    let folder = Folder::new();
    let heights = Pattern::Fbm.heights([9, 7], 5, 2.6);
    let heights = Heights::new([9, 7], [false; 2], heights).expect("heights");
    let flat = Patches::Bilinear;
    for (generator, layout, words) in [
        (Generator::Exact, Layout::Dummer, "from red"),
        (Generator::Exact, Layout::Pair, "from grey"),
        (Generator::Exact, Layout::Relief, "from alpha"),
        (Generator::RelaxedExact, Layout::Relief, "depths"),
        (Generator::Exact, Layout::Full, "the channel height"),
        (Generator::Quad, Layout::Full, "the channel height"),
    ] {
        let name = match layout {
            Layout::Full => "a.exr",
            _ => "a.png",
        };
        for bits in [Bits::Eight, Bits::Sixteen] {
            let format = MapFormat {
                bits,
                ..MapFormat::new(layout)
            };
            let bytes = encode(&map_of(&heights, generator, flat), &format).expect("a file");
            let held = decode_bytes(&bytes).expect("a map").heights;
            folder.write(name, &bytes);
            let (values, note) = loaded(&folder, name);
            assert_eq!(values, held.expect("heights"), "{format:?}");
            assert!(note.contains("cone map") && note.contains(words), "{note}");
        }
        // They are heights like others: they can be turned over and may wrap.
        let options = LoadOptions {
            wrap: [true, false],
            invert: true,
            ..LoadOptions::default()
        };
        let turned = load_as(&folder, name, &options).expect("heights").heights;
        assert_eq!(turned.wrap(), [true, false]);
        assert_eq!(turned.data()[3], 1.0 - values(&folder, name)[3]);
        refused_as(&folder, name, &sized([9, 7]), &["--size"]);
    }
    // Boxes are as many as samples, and as high.
    let boxes = map_of(&heights, Generator::Walk, Patches::Boxes);
    let bytes = encode(&boxes, &MapFormat::new(Layout::Full)).expect("a file");
    folder.write("boxes.exr", bytes);
    assert_eq!(values(&folder, "boxes.exr"), heights.data());
}

#[test]
fn a_cone_map_without_heights_of_samples_is_refused() {
    let folder = Folder::new();
    let tile = Pattern::Fbm.heights([8, 8], 5, 2.6);
    let tile = Heights::new([8, 8], [true; 2], tile).expect("heights");
    let write = |name: &str, file: &MapFile, layout| {
        let bytes = encode(file, &MapFormat::new(layout)).expect("a file");
        folder.write(name, &bytes);
        decode_bytes(&bytes).expect("a map")
    };
    let map = plain(Generator::Quad, &tile);
    let quad = MapFile::new(map, &tile, Patches::Bilinear, "quad");
    let quad = write("quad.png", &quad, Layout::Quad);
    write("quad.exr", &quad, Layout::Full);
    for name in ["quad.png", "quad.exr"] {
        let words = ["holds no heights", "that it was made from"];
        refused(&folder, name, &words);
    }
    for generator in [Generator::Walk, Generator::WalkRelaxed] {
        for (layout, name) in [(Layout::Pair, "walk.png"), (Layout::Full, "walk.exr")] {
            write(name, &map_of(&tile, generator, Patches::Bilinear), layout);
            let words = [generator.name(), "of cells", "that it was made from"];
            refused(&folder, name, &words);
        }
    }
}

#[test]
fn numbers_that_are_not_finite_are_refused_with_their_place() {
    let folder = Folder::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let words = ["column 3, row 1", &bad.to_string()];
        let mut z = vec![0.5; 12];
        z[7] = bad;
        folder.write("a-4x3.raw", raw(&z));
        folder.write("a.exr", exr([4, 3], vec![("Y", FlatSamples::F32(z))]));
        refused(&folder, "a-4x3.raw", &words);
        // Normalizing does not help.
        for options in [LoadOptions::default(), normalized()] {
            refused_as(&folder, "a.exr", &options, &words);
        }
    }
}

#[test]
fn metres_are_normalized_only_when_asked() {
    let folder = Folder::new();
    folder.write("dem.tif", tiff::<GrayI16>([2, 2], &[-100, 300, 100, 0]));
    refused(&folder, "dem.tif", &["from -100 to 300", "--normalize"]);
    // An even map has no range to stretch.
    folder.write("even-2x1.raw", raw(&[7.0, 7.0]));
    for (name, invert, heights) in [
        ("dem.tif", false, &[0.0, 1.0, 0.5, 0.25][..]),
        ("dem.tif", true, &[1.0, 0.0, 0.5, 0.75]),
        ("even-2x1.raw", false, &[0.0, 0.0]),
    ] {
        let mut options = normalized();
        options.invert = invert;
        let loaded = load_as(&folder, name, &options).expect("heights");
        assert_eq!(loaded.heights.data(), heights);
    }
}

#[test]
fn a_raw_file_needs_the_size_that_it_has() {
    let folder = Folder::new();
    folder.write("bare.raw", raw(&[0.0, 0.25, 0.5, 0.75, 1.0, 0.0]));
    folder.write("rows-3x2.raw", folder.bytes("bare.raw"));
    folder.write("grey.png", grey([1, 1], &[9]));
    let loaded = load_as(&folder, "bare.raw", &sized([3, 2])).expect("heights");
    assert_eq!(loaded.heights.size(), [3, 2]);
    assert_eq!(loaded.heights.at(0, 1), 0.75);
    load_as(&folder, "rows-3x2.raw", &sized([3, 2])).expect("its own size");
    refused(&folder, "bare.raw", &["--size", "heights-512x256.raw"]);
    for (name, size, words) in [
        ("bare.raw", [3, 3], &["24 bytes", "36"][..]),
        // A name and an option that disagree: one of them is wrong.
        ("rows-3x2.raw", [2, 3], &["3 x 2", "2 x 3"]),
        // As long as 16-bit numbers would be.
        ("bare.raw", [4, 3], &["16-bit"]),
        ("grey.png", [1, 1], &["--size"]),
    ] {
        refused_as(&folder, name, &sized(size), words);
    }
}

#[test]
fn no_pattern_is_flat_however_few_its_samples() {
    for pattern in Pattern::ALL {
        for n in [4, 8, 12, 16, 40] {
            let heights = pattern.heights([n, n], 1, 2.6);
            let row = |y: u32| &heights[(y * n) as usize..][..n as usize];
            let moves = |own: &[f32]| own.iter().any(|z| *z != own[0]);
            assert!(moves(&heights), "{pattern:?} {n}");
            // A checker changes along either axis.
            let across = pattern != Pattern::Checker || moves(row(0)) && row(0) != row(n - 1);
            assert!(across, "{n}");
        }
    }
}

#[test]
fn the_making_of_a_pattern_is_told_and_can_be_stopped() {
    for pattern in Pattern::ALL {
        let (mut shares, mut calls) = (Vec::new(), 0);
        let make = |watch: ShareWatch<'_>| pattern.watched([48, 33], 7, 2.6, watch);
        let made = make(&mut |share| {
            shares.push(share);
            true
        });
        assert_eq!(made, Some(pattern.heights([48, 33], 7, 2.6)));
        assert!(shares.is_sorted_by(|a, b| a < b), "{pattern:?}: {shares:?}");
        assert!(shares.len() >= 33 && shares.last() == Some(&1.0));
        let stopped = make(&mut |_| {
            calls += 1;
            calls < 5
        });
        assert_eq!((stopped, calls), (None, 5), "{pattern:?}");
    }
    // A render tells it before its passes.
    let mut plan = preset::load("terrain", &[]).expect("a preset").plan;
    let Scene::Heightfield(settings) = &mut plan.scene else {
        panic!("no heightfield");
    };
    settings.source.field = "fbm:64x48".into();
    let mut told = Vec::new();
    let watch = &mut |now: &Progress| {
        told.push(now.clone());
        now.done < 0.5
    };
    let ended = cpu::render(&plan, &Assets::default(), Extras::default(), watch);
    assert!(matches!(ended, Err(FrameError::Cancelled)));
    assert!(told.iter().all(|now| now.pass == "heights of fbm:64x48"));
    assert!(told.len() > 64 && told[0].done < 0.01);
}

#[test]
fn the_smallest_maps_are_maps() {
    let folder = Folder::new();
    for size in [[1, 1], [1, 5], [5, 1], [2, 2]] {
        let places = (size[0] * size[1]) as usize;
        let flat = FlatSamples::F32(vec![0.2; places]);
        folder.write("a.png", grey(size, &vec![51; places]));
        folder.write("a.exr", exr(size.map(|n| n as usize), vec![("Y", flat)]));
        for name in ["a.png", "a.exr"] {
            assert_eq!(values(&folder, name), vec![0.2; places]);
        }
    }
}

/// One good file of each format, each with more than one row.
fn good_files() -> [(&'static str, Vec<u8>); 4] {
    let bytes: Vec<u8> = (0..=255).collect();
    let floats: Vec<f32> = bytes.iter().map(|b| f32::from(*b) / 255.0).collect();
    let y = FlatSamples::F32(floats.clone());
    [
        ("a.png", grey([16, 16], &bytes)),
        ("a.exr", exr([16, 16], vec![("Y", y)])),
        ("a.tif", tiff::<Gray8>([16, 16], &bytes)),
        ("a-16x16.raw", raw(&floats)),
    ]
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let folder = Folder::new();
    for (name, good) in good_files() {
        folder.write(name, &good);
        let whole = values(&folder, name);
        assert_eq!(whole.len(), 256);
        let step = (good.len() / 50).max(1);
        for length in (0..good.len()).step_by(step).chain([good.len() - 1]) {
            folder.write(name, &good[..length]);
            match load_as(&folder, name, &LoadOptions::default()) {
                Err(why) => assert!(why.contains(name) && !why.contains('\n'), "{why}"),
                // A TIFF may end with bytes that no height depends on.
                Ok(loaded) => assert_eq!(
                    (loaded.heights.data(), name),
                    (whole.as_slice(), "a.tif"),
                    "cut to {length}"
                ),
            }
        }
        folder.write(name, []);
        refused(&folder, name, &["is empty"]);
    }
}

#[test]
fn a_file_that_claims_too_much_takes_no_memory() {
    let folder = Folder::new();
    let mut picture = Vec::new();
    let writer = png::Encoder::new(&mut picture, 100_000, 100_000).write_header();
    let written = writer.and_then(|mut w| w.write_chunk(png::chunk::IDAT, &[0; 8]));
    written.expect("a head and little more");
    let mut image = exr([1, 1], vec![("Y", FlatSamples::F32(vec![0.5]))]);
    // The largest corner of both windows, which follows the name and type of each.
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = image.windows(name.len()).position(|w| w == name);
        let corner = at.expect("a window") + name.len() + 4 + 8;
        image[corner..corner + 8]
            .copy_from_slice(&[0xFF, 0xFF, 0xFF, 0x3F, 0xFF, 0xFF, 0xFF, 0x3F]);
    }
    let mut scan = tiff::<Gray8>([300, 300], &[7; 90_000]);
    // Every 300 in a directory becomes 60000: width, height, rows of a strip.
    let directory = u32::from_le_bytes(scan[4..8].try_into().expect("four bytes")) as usize;
    for i in directory..scan.len() - 1 {
        if scan[i..i + 2] == 300u16.to_le_bytes() {
            scan[i..i + 2].copy_from_slice(&60_000u16.to_le_bytes());
        }
    }
    for (name, bytes, words) in [
        ("huge.png", picture, &["100000 x 100000", "8192"][..]),
        ("huge.exr", image, &[]),
        ("huge.tif", scan, &[]),
        ("huge-9000x9000.raw", vec![0; 4], &["--size"]),
    ] {
        folder.write(name, bytes);
        refused(&folder, name, words);
    }
}

fn field(argument: &str) -> Result<Loaded, FileError> {
    load(argument, &LoadOptions::default(), &mut |_| true)
}

#[test]
fn an_argument_that_names_no_heights_is_refused() {
    let folder = Folder::new();
    folder.write("photo.jpg", b"\xff\xd8\xff\xe0 and so on");
    folder.write("notes.txt", "heights");
    std::fs::create_dir(folder.0.join("a.png")).expect("a folder");
    for (name, words) in [
        ("photo.jpg", &["JPEG", "PNG"][..]),
        ("notes.txt", &["neither PNG, EXR nor TIFF"]),
        ("missing.png", &["cannot be read"]),
        ("a.png", &["is a folder"]),
    ] {
        refused(&folder, name, words);
    }
    for (argument, words) in [
        ("fmb", "fields are fbm, ridges"),
        ("", "fields are fbm"),
        ("fbm:4x4,seed=-1", "seed=-1"),
        ("fbm:seed=,4x4", "seed="),
        ("fbm:power=9", "power=9"),
        ("fbm:9000x1", "like 512x256"),
        ("noise:4x4,colour=red", "colour=red"),
    ] {
        let why = field(argument).expect_err(argument);
        assert!(why.is_usage() && why.to_string().contains(words), "{why}");
    }
    let named = field("noise:9x5,seed=3").expect("a field");
    assert_eq!(named.heights.data(), Pattern::Noise.heights([9, 5], 3, 2.6));
    let again = field("stones:power=3,9X9").expect("a field");
    assert_eq!(again.form, "stones:9x9,seed=1,power=3");
}
