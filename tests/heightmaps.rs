//! Height maps from files, and cone maps through files: every format, every rounding to
//! the safe side, and a sentence for everything that is wrong.

use conemarch::heightfield::conemap::MapKind;
use conemarch::heightfield::field::Field;
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::load::{LoadOptions, Loaded, load};
use conemarch::heightfield::mapfile::{
    Bits, Foreign, Form, Layout, MapFile, Ratios, Wanted, decode, decode_bytes, encode, has_map,
    read_map,
};
use conemarch::output::write_map;
use exr::prelude::FlatSamples;
use png::{BitDepth, ColorType};
use proptest::prelude::*;
use tiff::encoder::colortype;

#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod every_pair;
    pub mod folder;
    pub mod pictures;
}
use common::every_pair::{Places, map};
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
    let named = load("sine:9x5,seed=3", &LoadOptions::default()).expect("a field");
    assert_eq!(named.heights.data(), Field::Sine.heights([9, 5], 3, 2.6));
}

// Cone maps.

const KINDS: [MapKind; 5] = [
    MapKind::Samples,
    MapKind::Quad,
    MapKind::Relaxed,
    MapKind::Walk,
    MapKind::WalkRelaxed,
];

fn made(heights: &Heights, kind: MapKind) -> MapFile {
    let map = map(heights, kind, 1.5);
    MapFile::new(map, heights, Patches::Bilinear, "every pair")
}

fn field(size: [u32; 2], wrap: [bool; 2]) -> Heights {
    Heights::new(size, wrap, Field::Fbm.heights(size, 5, 2.6)).expect("heights")
}

/// Every form that can hold a kind.
fn forms(kind: MapKind) -> Vec<Form> {
    let layouts = Layout::ALL.into_iter().filter(|l| l.lacks(kind).is_none());
    layouts
        .flat_map(|layout| {
            let usual = Form::new(layout);
            let all = [Bits::Eight, Bits::Sixteen].into_iter();
            all.flat_map(move |bits| {
                [true, false].map(move |root| Form {
                    bits,
                    root,
                    ..usual
                })
            })
        })
        .collect()
}

/// Heights in a grid that is often tiny, on steps of 8 bits or not.
fn any_heights() -> impl Strategy<Value = Heights> {
    let size = (1u32..9, 1u32..9);
    (size, any::<[bool; 2]>(), any::<bool>()).prop_flat_map(|((w, h), wrap, stepped)| {
        let one = prop_oneof![4 => 0.0f32..1.0, 1 => Just(0.0f32), 1 => Just(1.0f32)];
        proptest::collection::vec(one, (w * h) as usize).prop_map(move |mut z| {
            for z in z.iter_mut().filter(|_| stepped) {
                *z = (f64::from((*z * 255.0).round()) / 255.0) as f32;
            }
            Heights::new([w, h], wrap, z).expect("heights")
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_cone_is_wider_and_no_height_lower_after_a_round_trip(heights in any_heights()) {
        for kind in KINDS {
            let file = made(&heights, kind);
            for form in forms(kind) {
                let bytes = encode(&file, &form).expect("a file");
                let read = decode_bytes(&bytes).expect("a map");
                prop_assert_eq!(&read.label, &file.label);
                prop_assert_eq!(read.map.kind, kind);
                prop_assert_eq!(read.map.wrap, heights.wrap());
                prop_assert_eq!(read.map.offset, file.map.offset);
                for (after, before) in read.map.ratios.iter().zip(&file.map.ratios) {
                    prop_assert!(after <= before, "{after} after {before}: {form:?}");
                }
                let full = form.layout == Layout::Full;
                let step = if full { 0.0 } else { 1.0 / f32::from(form.bits.steps().most) };
                let pairs = read.heights.iter().flatten().zip(file.heights.iter().flatten());
                for (after, before) in pairs {
                    prop_assert!(after >= before && after - before <= step * 1.0001);
                }
                // What was read once is held as it is.
                let again = encode(&read, &form).and_then(|b| Ok(decode_bytes(&b)));
                let again = again.expect("a file").expect("a map");
                prop_assert_eq!(&again.map, &read.map, "{:?}", form);
                prop_assert_eq!(&again.heights, &read.heights);
            }
        }
    }

    #[test]
    fn cones_in_a_file_are_empty_over_the_heights_in_it(heights in any_heights()) {
        // Eight bits move heights by far more than any cone has to spare.
        for kind in [MapKind::Samples, MapKind::Walk] {
            let file = made(&heights, kind);
            for form in forms(kind) {
                let bytes = encode(&file, &form).expect("a file");
                let read = decode_bytes(&bytes).expect("a map");
                let mut places = Places::of(&heights, kind, 1.5);
                prop_assert!(places.widest(&read.map.ratios) <= 1.0);
                places.heights = read.heights.expect("heights");
                let widest = places.widest(&read.map.ratios);
                prop_assert!(widest <= 1.0 + 1e-12, "{widest} times too wide: {form:?}");
            }
        }
    }

    #[test]
    fn a_broken_map_is_an_error_and_nothing_worse(at in 0.0f64..1.0, bit in 0u8..8, cut in 0.0f64..1.2) {
        for layout in [Layout::Dummer, Layout::Full] {
            let file = made(&field([6, 5], [false, true]), MapKind::Samples);
            let mut bytes = encode(&file, &Form::new(layout)).expect("a file");
            let i = (at * (bytes.len() - 1) as f64) as usize;
            bytes[i] ^= 1 << bit;
            bytes.truncate((cut * bytes.len() as f64) as usize);
            if let Err(why) = decode_bytes(&bytes) {
                prop_assert!(!why.contains('\n'), "{}", why);
            }
        }
    }
}

#[test]
fn what_a_form_keeps() {
    // Sharp enough that a form that narrows everything to nothing is found out.
    let heights = field([32, 32], [false; 2]);
    let file = made(&heights, MapKind::Samples);
    let kept = |form: Form| {
        let bytes = encode(&file, &form).expect("a file");
        decode_bytes(&bytes).expect("a map").mean_share() / file.mean_share()
    };
    let pair = Form::new(Layout::Pair);
    assert!(kept(Form::new(Layout::Full)) > 0.999_999_8);
    assert!(kept(pair) > 0.999, "{}", kept(pair));
    let narrow = Form {
        bits: Bits::Eight,
        ..pair
    };
    assert!(
        kept(narrow) > 0.93 && kept(narrow) < kept(pair),
        "{}",
        kept(narrow)
    );
    // Heights of 8 bits are held as they are, and take nothing from the cones.
    let stepped = heights.data().iter().map(|z| (z * 255.0).round() / 255.0);
    let stepped = Heights::new([32, 32], [false; 2], stepped.collect()).expect("heights");
    let file = made(&stepped, MapKind::Samples);
    let bytes = encode(&file, &Form::new(Layout::Dummer)).expect("a file");
    let read = decode_bytes(&bytes).expect("a map");
    assert_eq!(read.heights, file.heights);
    let ratios = Ratios {
        steps: Bits::Eight.steps(),
        root: true,
        scale: 32.0,
    };
    let down = file
        .map
        .ratios
        .iter()
        .map(|r| ratios.ratio(ratios.ratio_down(*r)));
    assert!(read.map.ratios.iter().copied().eq(down));
}

#[test]
fn channels_are_those_of_the_papers() {
    // A peak beside flat ground: a ratio of one texel, an eighth of the longer axis.
    let mut z = vec![0.0; 8 * 4];
    z[8 + 3] = 1.0;
    let heights = Heights::new([8, 4], [false; 2], z).expect("heights");
    let file = made(&heights, MapKind::Samples);
    let pixels = |form: Form| {
        let bytes = encode(&file, &form).expect("a file");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut pixels).expect("pixels");
        (reader.info().color_type, pixels)
    };
    let (color, rgba) = pixels(Form::new(Layout::Dummer));
    assert_eq!(color, ColorType::Rgba);
    // Left of the peak: height 0; the square root of 1/8, rounded down; the surface rises
    // by half its height over one texel; flat along y.
    let root = (255.0 * (1.0f64 / 8.0).sqrt()).floor() as u8;
    assert_eq!(rgba[4 * 10..4 * 11], [0, root, 255, 128]);
    // Above it: it rises downwards in the picture, which is down where y goes up.
    assert_eq!(rgba[4 * 3..4 * 4], [0, root, 128, 0]);
    // The peak: nothing is higher, so the cone is as wide as the channel goes.
    assert_eq!(rgba[4 * 11..4 * 11 + 2], [255, 255]);
    let (color, relief) = pixels(Form::new(Layout::Relief));
    assert_eq!(color, ColorType::Rgba);
    // Normal, ratio as it is, depth: the normal leans left by the slope of 0.5 x 2 texels.
    let lean = (0.5 - 0.5 * 0.5f64.sqrt()) * 255.0;
    let expected = [(lean + 0.5) as u8, 128, 31, 255];
    assert_eq!(relief[4 * 10..4 * 11], expected);
    assert_eq!(relief[4 * 11 + 3], 0, "the highest has no depth");
    let (color, pair) = pixels(Form {
        bits: Bits::Eight,
        ..Form::new(Layout::Pair)
    });
    assert_eq!(color, ColorType::GrayscaleAlpha);
    assert_eq!(pair[2 * 10..2 * 11], [0, root]);
}

#[test]
fn a_map_is_refused_for_what_it_was_not_made_for() {
    let folder = Folder::new();
    let heights = field([12, 10], [true, false]);
    let path = folder.0.join("a.png");
    let file = made(&heights, MapKind::Samples);
    write_map(&path, &file, &Form::new(Layout::Dummer)).expect("a file");
    assert_eq!(folder.files(), ["a.png"]);
    let read = read_map(&path).expect("a map");
    let wanted = Wanted {
        who: "the tracer `csm-exact`",
        kinds: &[MapKind::Samples],
        heights: &heights,
        patches: Patches::Bilinear,
    };
    read.fit(&path, &wanted).expect("its own heights");
    let refuse = |wanted: &Wanted<'_>, words: &[&str]| {
        let why = read.fit(&path, wanted).expect_err("a misfit").to_string();
        assert!(why.contains("a.png") && !why.contains('\n'), "{why}");
        for word in words {
            assert!(why.contains(word), "`{word}` not in: {why}");
        }
    };
    let kinds = &[MapKind::Walk, MapKind::WalkRelaxed];
    let words = ["`samples`", "csm-exact", "needs `walk` or `walk-relaxed`"];
    refuse(&Wanted { kinds, ..wanted }, &words);
    let remade = |wrap, data: Vec<f32>| Heights::new([12, 10], wrap, data).expect("heights");
    let data = heights.data().to_vec();
    let other = remade([false; 2], data.clone());
    let words = ["wrap along x", "wrap along none", "--wrap none"];
    refuse(
        &Wanted {
            heights: &other,
            ..wanted
        },
        &words,
    );
    let mut touched = data.clone();
    touched[77] = touched[77].next_down();
    let other = remade([true, false], touched);
    refuse(
        &Wanted {
            heights: &other,
            ..wanted
        },
        &["other heights", "--invert"],
    );
    let other = field([10, 12], [true, false]);
    refuse(
        &Wanted {
            heights: &other,
            ..wanted
        },
        &["12 x 10", "10 x 12"],
    );

    // Only a walk depends on what lies between the samples.
    let boxes = Patches::Boxes;
    read.fit(
        &path,
        &Wanted {
            patches: boxes,
            ..wanted
        },
    )
    .expect("samples are samples");
    let walk = made(&heights, MapKind::Walk);
    let bytes = encode(&walk, &Form::new(Layout::Full)).expect("a file");
    let walk = decode_bytes(&bytes).expect("a map");
    let wanted = Wanted {
        kinds: &[],
        patches: boxes,
        ..wanted
    };
    let why = walk.fit(&path, &wanted).expect_err("boxes").to_string();
    assert!(
        why.contains("bilinear patches") && why.contains("boxes"),
        "{why}"
    );
}

#[test]
fn a_map_of_another_program_is_read_as_what_it_is_said_to_be() {
    let folder = Folder::new();
    let heights = field([8, 8], [false; 2]);
    let file = made(&heights, MapKind::Samples);
    let ours = encode(&file, &Form::new(Layout::Dummer)).expect("a file");
    let mut reader = png::Decoder::new(std::io::Cursor::new(ours))
        .read_info()
        .expect("a PNG");
    let mut rgba = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut rgba).expect("pixels");
    folder.write(
        "theirs.png",
        png([8, 8], ColorType::Rgba, BitDepth::Eight, &rgba),
    );
    let path = folder.0.join("theirs.png");
    assert!(!has_map(&path).expect("a file"));
    let why = read_map(&path).expect_err("no label").to_string();
    assert!(
        why.contains("theirs.png") && why.contains("--from"),
        "{why}"
    );
    let foreign = Foreign {
        layout: Layout::Dummer,
        kind: MapKind::Samples,
        root: true,
        wrap: [false; 2],
    };
    let read = decode(&path, Some(&foreign)).expect("a map");
    let same = encode(&file, &Form::new(Layout::Dummer)).expect("a file");
    assert_eq!(read.map, decode_bytes(&same).expect("a map").map);
    // Its heights are all that tells whose it is.
    let wanted = |heights| Wanted {
        who: "this test",
        kinds: &[],
        heights,
        patches: Patches::Bilinear,
    };
    read.fit(&path, &wanted(&heights)).expect("its heights");
    let other = Field::Noise.heights([8, 8], 1, 0.0);
    let other = Heights::new([8, 8], [false; 2], other).expect("heights");
    assert!(read.fit(&path, &wanted(&other)).is_err());
    // A map is four channels wide.
    folder.write(
        "three.png",
        png([1, 1], ColorType::Rgb, BitDepth::Eight, &[1, 2, 3]),
    );
    let why = decode(&folder.0.join("three.png"), Some(&foreign)).expect_err("three");
    assert!(why.to_string().contains("3 channels"), "{why}");
}

#[test]
fn a_map_that_was_cut_or_says_nonsense_is_refused() {
    let folder = Folder::new();
    let heights = field([8, 8], [false; 2]);
    let file = made(&heights, MapKind::Samples);
    // A label of 8 x 8 samples on an image of 4 x 4.
    let mut cut = file.clone();
    cut.map.size = [4, 4];
    cut.map.ratios.truncate(16);
    cut.heights = cut.heights.map(|z| z[..16].to_vec());
    for layout in [Layout::Pair, Layout::Full] {
        let bytes = encode(&cut, &Form::new(layout)).expect("a file");
        let why = decode_bytes(&bytes).expect_err("cut");
        assert!(why.contains("4 x 4") && why.contains("8 x 8"), "{why}");
    }
    let mut wrong = file.clone();
    wrong.label.scale = f64::NAN;
    let bytes = encode(&wrong, &Form::new(Layout::Pair)).expect("a file");
    let why = decode_bytes(&bytes).expect_err("no scale");
    assert!(why.contains("scale"), "{why}");
    folder.write("a.txt", "nothing");
    let why = read_map(&folder.0.join("a.txt"))
        .expect_err("no map")
        .to_string();
    assert!(why.contains("a.txt") && why.contains("PNG or EXR"), "{why}");
}

#[test]
fn layouts_say_what_they_cannot_hold() {
    let heights = field([4, 4], [false; 2]);
    for (kind, layout, words) in [
        (MapKind::Quad, Layout::Dummer, "take quad or full"),
        (MapKind::Walk, Layout::Dummer, "take pair or full"),
        (MapKind::WalkRelaxed, Layout::Relief, "take pair or full"),
        (MapKind::Samples, Layout::Quad, "four ratios"),
    ] {
        let why = encode(&made(&heights, kind), &Form::new(layout)).expect_err("no place");
        assert!(why.is_usage() && why.to_string().contains(words), "{why}");
    }
    // A map without heights cannot become one with them.
    let bytes = encode(&made(&heights, MapKind::Quad), &Form::new(Layout::Quad)).expect("a file");
    let read = decode_bytes(&bytes).expect("a map");
    assert!(read.heights.is_none());
}
