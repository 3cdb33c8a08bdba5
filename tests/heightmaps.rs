//! Height maps from files: every format, and a sentence for everything that is wrong.

use conemarch::heightfield::conemap::file::{Bits, Form, Layout, MapFile, decode_bytes, encode};
use conemarch::heightfield::conemap::generate::cpu;
use conemarch::heightfield::conemap::generate::generator::{Generator, Options};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::load::{LoadOptions, Loaded, load};
use conemarch::heightfield::pattern::Pattern;
use exr::prelude::FlatSamples;
use png::{BitDepth, ColorType};
use tiff::encoder::colortype;

#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod folder;
    pub mod pictures;
}
use common::folder::Folder;
use common::pictures::{exr, png, raw, tiff, wide};

/// Loads a file of a test's folder.
fn load_as(folder: &Folder, name: &str, options: &LoadOptions) -> Result<Loaded, String> {
    let path = folder.0.join(name);
    load(&path.display().to_string(), options).map_err(|e| e.to_string())
}

fn values(folder: &Folder, name: &str) -> Vec<f32> {
    let loaded = load_as(folder, name, &LoadOptions::default());
    loaded.expect(name).heights.data().to_vec()
}

fn note(folder: &Folder, name: &str) -> String {
    let loaded = load_as(folder, name, &LoadOptions::default());
    loaded.expect(name).note.unwrap_or_default()
}

/// Checks that a file is refused in one sentence with its name and some words.
fn refused(folder: &Folder, name: &str, words: &[&str]) {
    let why = load_as(folder, name, &LoadOptions::default()).expect_err(name);
    assert!(why.contains(name), "{why}");
    assert!(!why.contains('\n'), "{why}");
    for word in words {
        assert!(why.contains(word), "`{word}` not in: {why}");
    }
}

#[test]
fn a_png_of_any_kind_is_read() {
    let folder = Folder::new();
    let bits = BitDepth::Eight;
    folder.write(
        "grey.png",
        png([2, 1], ColorType::Grayscale, bits, &[0, 51]),
    );
    assert_eq!(values(&folder, "grey.png"), [0.0, 0.2]);
    let deep = png(
        [2, 1],
        ColorType::Grayscale,
        BitDepth::Sixteen,
        &wide(&[13107, 65535]),
    );
    folder.write("deep.png", deep);
    assert_eq!(values(&folder, "deep.png"), [0.2, 1.0]);
    // One bit, rows from the highest: white, black, white.
    let bit = png([3, 1], ColorType::Grayscale, BitDepth::One, &[0b1010_0000]);
    folder.write("bit.png", bit);
    assert_eq!(values(&folder, "bit.png"), [1.0, 0.0, 1.0]);
    folder.write(
        "palette.png",
        png([2, 1], ColorType::Indexed, bits, &[1, 2]),
    );
    assert_eq!(values(&folder, "palette.png"), [0.2, 1.0]);
    assert_eq!(note(&folder, "palette.png"), "");
    let even = png([1, 2], ColorType::Rgb, bits, &[51, 51, 51, 255, 255, 255]);
    folder.write("even.png", even);
    assert_eq!(values(&folder, "even.png"), [0.2, 1.0]);
    assert_eq!(note(&folder, "even.png"), "");
    // Red counts, and somebody is told.
    folder.write("red.png", png([1, 1], ColorType::Rgb, bits, &[51, 0, 255]));
    assert_eq!(values(&folder, "red.png"), [0.2]);
    assert!(
        note(&folder, "red.png").contains("red"),
        "{}",
        note(&folder, "red.png")
    );
}

#[test]
fn alpha_is_no_height() {
    let folder = Folder::new();
    let sixteen = BitDepth::Sixteen;
    let samples = wide(&[13107, 65535, 65535, 0]);
    folder.write(
        "ga.png",
        png([2, 1], ColorType::GrayscaleAlpha, sixteen, &samples),
    );
    assert_eq!(values(&folder, "ga.png"), [0.2, 1.0]);
    assert!(note(&folder, "ga.png").contains("alpha"));
    let full = wide(&[13107, 65535, 65535, 65535]);
    folder.write(
        "full.png",
        png([2, 1], ColorType::GrayscaleAlpha, sixteen, &full),
    );
    assert_eq!(note(&folder, "full.png"), "", "full alpha is no news");
    let samples = wide(&[13107, 13107, 13107, 7]);
    folder.write("rgba.png", png([1, 1], ColorType::Rgba, sixteen, &samples));
    assert_eq!(values(&folder, "rgba.png"), [0.2]);
    assert!(note(&folder, "rgba.png").contains("alpha"));
}

#[test]
fn an_exr_has_its_heights_in_the_channel_that_says_so() {
    let folder = Folder::new();
    let one = |z: f32| FlatSamples::F32(vec![z, 0.0]);
    let rgb = vec![("R", one(0.1)), ("G", one(0.2)), ("B", one(0.3))];
    folder.write("rgb.exr", exr([2, 1], rgb));
    assert_eq!(values(&folder, "rgb.exr"), [0.1, 0.0]);
    let depth = vec![("A", one(0.5)), ("R", one(0.1)), ("depth.Z", one(0.7))];
    folder.write("z.exr", exr([2, 1], depth));
    assert_eq!(values(&folder, "z.exr"), [0.7, 0.0]);
    let named = vec![("Y", one(0.5)), ("height", one(0.25)), ("Z", one(0.7))];
    folder.write("named.exr", exr([1, 2], named));
    assert_eq!(values(&folder, "named.exr"), [0.25, 0.0]);
    assert!(note(&folder, "named.exr").contains("height is the height"));
    let half = FlatSamples::F16(vec![exr::prelude::f16::from_f32(0.5); 2]);
    folder.write("half.exr", exr([2, 1], vec![("lonely", half)]));
    assert_eq!(values(&folder, "half.exr"), [0.5, 0.5]);
    folder.write(
        "uv.exr",
        exr([2, 1], vec![("U", one(0.5)), ("V", one(0.5))]),
    );
    refused(&folder, "uv.exr", &["channels U, V", "rename"]);
}

/// A generator's map of some heights.
fn map_of(heights: &Heights, generator: Generator, patches: Patches) -> MapFile {
    let options = Options::default();
    let map = cpu::generate(generator, heights, patches, &options, &mut |_| true);
    MapFile::new(map.expect("a map"), heights, patches, generator.name())
}

#[test]
fn a_cone_map_has_its_heights_where_its_layout_has_them() {
    let folder = Folder::new();
    let heights = Pattern::Fbm.heights([9, 7], 5, 2.6);
    let heights = Heights::new([9, 7], [false; 2], heights).expect("heights");
    let flat = Patches::Bilinear;
    for (generator, layout, name, words) in [
        (Generator::Exact, Layout::Dummer, "a.png", "from red"),
        (Generator::Exact, Layout::Pair, "a.png", "from grey"),
        (
            Generator::Exact,
            Layout::HeightSurface,
            "a.png",
            "from alpha",
        ),
        (
            Generator::RelaxedExact,
            Layout::HeightSurface,
            "a.png",
            "depths",
        ),
        (
            Generator::Exact,
            Layout::Full,
            "a.exr",
            "the channel height",
        ),
        (Generator::Quad, Layout::Full, "a.exr", "the channel height"),
    ] {
        for bits in [Bits::Eight, Bits::Sixteen] {
            let form = Form {
                bits,
                ..Form::new(layout)
            };
            let bytes = encode(&map_of(&heights, generator, flat), &form).expect("a file");
            let held = decode_bytes(&bytes).expect("a map").heights;
            folder.write(name, &bytes);
            assert_eq!(values(&folder, name), held.expect("heights"), "{form:?}");
            let note = note(&folder, name);
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
        let sized = LoadOptions {
            size: Some([9, 7]),
            ..LoadOptions::default()
        };
        let why = load_as(&folder, name, &sized).expect_err("a size of its own");
        assert!(why.contains("--size"), "{why}");
    }
    // Boxes are as many as samples, and as high.
    let boxes = map_of(&heights, Generator::Walk, Patches::Boxes);
    let bytes = encode(&boxes, &Form::new(Layout::Full)).expect("a file");
    folder.write("boxes.exr", bytes);
    assert_eq!(values(&folder, "boxes.exr"), heights.data());
}

#[test]
fn a_cone_map_without_heights_of_samples_is_refused() {
    let folder = Folder::new();
    let tile = Pattern::Fbm.heights([8, 8], 5, 2.6);
    let tile = Heights::new([8, 8], [true; 2], tile).expect("heights");
    let of = |generator| map_of(&tile, generator, Patches::Bilinear);
    let quad = encode(&of(Generator::Quad), &Form::new(Layout::Quad)).expect("a file");
    folder.write("quad.png", &quad);
    let words = ["holds no heights", "that it was made from"];
    refused(&folder, "quad.png", &words);
    let quad = decode_bytes(&quad).expect("a map");
    let quad = encode(&quad, &Form::new(Layout::Full)).expect("a file");
    folder.write("quad.exr", quad);
    refused(&folder, "quad.exr", &words);
    for generator in [Generator::Walk, Generator::WalkRelaxed] {
        for (layout, name) in [(Layout::Pair, "walk.png"), (Layout::Full, "walk.exr")] {
            let bytes = encode(&of(generator), &Form::new(layout)).expect("a file");
            folder.write(name, bytes);
            let words = [generator.name(), "of cells", "that it was made from"];
            refused(&folder, name, &words);
        }
    }
}

#[test]
fn what_is_no_number_is_refused_with_its_place() {
    let folder = Folder::new();
    for (name, bad, said) in [
        ("nan.exr", f32::NAN, "NaN"),
        ("inf.exr", f32::INFINITY, "inf"),
        ("minus.exr", f32::NEG_INFINITY, "-inf"),
    ] {
        let mut z = vec![0.5; 12];
        z[7] = bad;
        folder.write(name, exr([4, 3], vec![("Y", FlatSamples::F32(z.clone()))]));
        refused(&folder, name, &["column 3, row 1", said]);
        // Normalizing does not help against it.
        let options = LoadOptions {
            normalize: true,
            ..LoadOptions::default()
        };
        assert!(load_as(&folder, name, &options).is_err());
        let raw_name = format!("{name}-4x3.raw");
        folder.write(&raw_name, raw(&z));
        refused(&folder, &raw_name, &["column 3, row 1", said]);
    }
}

#[test]
fn metres_are_normalized_only_when_asked() {
    let folder = Folder::new();
    let metres = tiff::<colortype::GrayI16>([2, 2], &[-100, 300, 100, 0]);
    folder.write("dem.tif", metres);
    refused(&folder, "dem.tif", &["from -100 to 300", "--normalize"]);
    let options = LoadOptions {
        normalize: true,
        ..LoadOptions::default()
    };
    let loaded = load_as(&folder, "dem.tif", &options).expect("heights");
    assert_eq!(loaded.heights.data(), [0.0, 1.0, 0.5, 0.25]);
    let options = LoadOptions {
        invert: true,
        ..options
    };
    let loaded = load_as(&folder, "dem.tif", &options).expect("heights");
    assert_eq!(loaded.heights.data(), [1.0, 0.0, 0.5, 0.75]);
    // An even map has no range to stretch.
    folder.write("even-2x1.raw", raw(&[7.0, 7.0]));
    let options = LoadOptions {
        invert: false,
        ..options
    };
    let loaded = load_as(&folder, "even-2x1.raw", &options).expect("heights");
    assert_eq!(loaded.heights.data(), [0.0, 0.0]);
    // What is within 0 to 1 stays as it is.
    folder.write("dent-2x1.raw", raw(&[0.4, 0.5]));
    assert_eq!(values(&folder, "dent-2x1.raw"), [0.4, 0.5]);
}

#[test]
fn a_tiff_of_any_number_is_read() {
    let folder = Folder::new();
    folder.write("8.tif", tiff::<colortype::Gray8>([2, 1], &[0, 51]));
    assert_eq!(values(&folder, "8.tif"), [0.0, 0.2]);
    folder.write("16.tif", tiff::<colortype::Gray16>([2, 1], &[13107, 65535]));
    assert_eq!(values(&folder, "16.tif"), [0.2, 1.0]);
    let floats = tiff::<colortype::Gray32Float>([2, 1], &[0.2, 0.75]);
    folder.write("float.tif", floats);
    assert_eq!(values(&folder, "float.tif"), [0.2, 0.75]);
    let rgb = tiff::<colortype::RGB8>([2, 1], &[51, 1, 2, 255, 3, 4]);
    folder.write("rgb.tif", rgb);
    assert_eq!(values(&folder, "rgb.tif"), [0.2, 1.0]);
    assert!(note(&folder, "rgb.tif").contains("first"));
}

#[test]
fn a_raw_file_needs_the_size_that_it_has() {
    let folder = Folder::new();
    folder.write("bare.raw", raw(&[0.0, 0.25, 0.5, 0.75, 1.0, 0.0]));
    refused(&folder, "bare.raw", &["--size", "heights-512x256.raw"]);
    let sized = |size| LoadOptions {
        size: Some(size),
        ..LoadOptions::default()
    };
    let loaded = load_as(&folder, "bare.raw", &sized([3, 2])).expect("heights");
    assert_eq!(loaded.heights.size(), [3, 2]);
    assert_eq!(loaded.heights.at(0, 1), 0.75);
    let why = load_as(&folder, "bare.raw", &sized([3, 3])).expect_err("too few");
    assert!(why.contains("24 bytes") && why.contains("36"), "{why}");
    // A name and an option that disagree: one of them is wrong.
    folder.write("rows-3x2.raw", folder.bytes("bare.raw"));
    let why = load_as(&folder, "rows-3x2.raw", &sized([2, 3])).expect_err("another size");
    assert!(why.contains("3 x 2") && why.contains("2 x 3"), "{why}");
    load_as(&folder, "rows-3x2.raw", &sized([3, 2])).expect("its own size");
    // As long as 16-bit numbers would be.
    let why = load_as(&folder, "bare.raw", &sized([4, 3])).expect_err("too few");
    assert!(why.contains("16-bit"), "{why}");
    folder.write(
        "grey.png",
        png([1, 1], ColorType::Grayscale, BitDepth::Eight, &[9]),
    );
    let why = load_as(&folder, "grey.png", &sized([1, 1])).expect_err("a size of its own");
    assert!(why.contains("--size"), "{why}");
}

#[test]
fn no_field_is_flat_however_few_its_samples() {
    for field in Pattern::ALL {
        for n in [4, 8, 12, 16, 40] {
            let heights = field.heights([n, n], 1, 2.6);
            let row = |y: u32| &heights[(y * n) as usize..][..n as usize];
            let moves = |own: &[f32]| own.iter().any(|z| *z != own[0]);
            assert!(moves(&heights), "{field:?} {n}");
            // A checker changes along either axis.
            let across = field != Pattern::Checker || moves(row(0)) && row(0) != row(n - 1);
            assert!(across, "{n}");
        }
    }
}

#[test]
fn the_smallest_maps_are_maps() {
    let folder = Folder::new();
    for size in [[1, 1], [1, 5], [5, 1], [2, 2]] {
        let places = (size[0] * size[1]) as usize;
        let grey = png(
            size,
            ColorType::Grayscale,
            BitDepth::Eight,
            &vec![51; places],
        );
        folder.write("a.png", grey);
        assert_eq!(values(&folder, "a.png"), vec![0.2; places]);
        let flat = FlatSamples::F32(vec![0.2; places]);
        folder.write("a.exr", exr(size.map(|n| n as usize), vec![("Y", flat)]));
        assert_eq!(values(&folder, "a.exr"), vec![0.2; places]);
    }
}

/// One good file of each format, each with more than one row.
fn good_files() -> [(&'static str, Vec<u8>); 4] {
    let bytes: Vec<u8> = (0..=255).collect();
    let floats: Vec<f32> = bytes.iter().map(|b| f32::from(*b) / 255.0).collect();
    let y = FlatSamples::F32(floats.clone());
    [
        (
            "a.png",
            png([16, 16], ColorType::Grayscale, BitDepth::Eight, &bytes),
        ),
        ("a.exr", exr([16, 16], vec![("Y", y)])),
        ("a.tif", tiff::<colortype::Gray8>([16, 16], &bytes)),
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
                // A TIFF may end with what no height depends on.
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
    let [(_, mut picture), ..] = good_files();
    // Width and height stand at byte 16; the checksum after them is made right.
    picture[16..24].copy_from_slice(&[0, 1, 0x86, 0xA0, 0, 1, 0x86, 0xA0]);
    let crc = crc32(&picture[12..29]);
    picture[29..33].copy_from_slice(&crc.to_be_bytes());
    folder.write("huge.png", picture);
    refused(&folder, "huge.png", &["100000 x 100000", "8192"]);
    let mut image = exr([1, 1], vec![("Y", FlatSamples::F32(vec![0.5]))]);
    // The largest corner of both windows, one after the name and type of each.
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = image.windows(name.len()).position(|w| w == name);
        let corner = at.expect("a window") + name.len() + 4 + 8;
        image[corner..corner + 8]
            .copy_from_slice(&[0xFF, 0xFF, 0xFF, 0x3F, 0xFF, 0xFF, 0xFF, 0x3F]);
    }
    folder.write("huge.exr", image);
    refused(&folder, "huge.exr", &[]);
    let mut scan = tiff::<colortype::Gray8>([300, 300], &[7; 90_000]);
    // Every 300 in a directory becomes 60000: width, height, rows of a strip.
    let directory = u32::from_le_bytes(scan[4..8].try_into().expect("four bytes")) as usize;
    for i in directory..scan.len() - 1 {
        if scan[i..i + 2] == 300u16.to_le_bytes() {
            scan[i..i + 2].copy_from_slice(&60_000u16.to_le_bytes());
        }
    }
    folder.write("huge.tif", scan);
    refused(&folder, "huge.tif", &[]);
    folder.write("huge-9000x9000.raw", [0; 4]);
    refused(&folder, "huge-9000x9000.raw", &["--size"]);
}

/// The checksum of PNG chunks.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            (c >> 1) ^ if c & 1 == 1 { 0xEDB8_8320 } else { 0 }
        })
    };
    !bytes.iter().fold(!0, step)
}

#[test]
fn what_is_no_height_map_is_told_so() {
    let folder = Folder::new();
    folder.write("photo.jpg", b"\xff\xd8\xff\xe0 and so on");
    refused(&folder, "photo.jpg", &["JPEG", "PNG"]);
    folder.write("notes.txt", "heights");
    refused(&folder, "notes.txt", &["neither PNG, EXR nor TIFF"]);
    refused(&folder, "missing.png", &["cannot be read"]);
    std::fs::create_dir(folder.0.join("a.png")).expect("a folder");
    refused(&folder, "a.png", &["is a folder"]);
    for (argument, words) in [
        ("fmb", "fields are fbm, ridges"),
        ("", "fields are fbm"),
        ("fbm:0x5", "like 512x256"),
        ("fbm:4x4,seed=-1", "seed=-1"),
        ("fbm:4x4,power=x", "power=x"),
        ("noise:4x4,colour=red", "colour=red"),
    ] {
        let why = load(argument, &LoadOptions::default()).expect_err(argument);
        assert!(why.is_usage() && why.to_string().contains(words), "{why}");
    }
    let named = load("noise:9x5,seed=3", &LoadOptions::default()).expect("a field");
    assert_eq!(named.heights.data(), Pattern::Noise.heights([9, 5], 3, 2.6));
}
