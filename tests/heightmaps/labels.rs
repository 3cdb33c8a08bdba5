//! Labels keep a map from heights and tracers that it was not made for, and a sentence tells
//! what is wrong with a file.

use std::path::Path;

use conemarch::heightfield::conemap::MapKind;
use conemarch::heightfield::conemap::file::{
    ForeignFormat, Layout, MapFile, MapFormat, MapUse, RatioScale, decode, decode_bytes, encode,
    has_map, read_map,
};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use png::{BitDepth, ColorType, text_metadata::TEXtChunk};

use crate::folder::Folder;
use crate::map_files::{eight, encoded, field, made, through};
use crate::pictures::{pixels, png};

/// Any use of a map over heights.
fn any_use(heights: &Heights) -> MapUse<'_> {
    MapUse {
        who: "this test",
        kinds: &[],
        heights,
        patches: Patches::Bilinear,
    }
}

/// Whether a map can be used over heights.
fn fits(file: &MapFile, heights: &Heights) -> bool {
    let path = Path::new("a.png");
    file.check_use(path, &any_use(heights)).is_ok()
}

#[test]
fn a_map_is_refused_for_what_it_was_not_made_for() {
    let folder = Folder::new();
    let heights = field([12, 10], [true, false]);
    let path = folder.0.join("a.png");
    let file = made(&heights, MapKind::Samples);
    let bytes = encode(&file, &MapFormat::new(Layout::Dummer)).expect("a layout that fits");
    std::fs::write(&path, bytes).expect("a file");
    let read = read_map(&path).expect("a map");
    let good = MapUse {
        who: "the tracer `csm-exact`",
        kinds: &[MapKind::Samples],
        ..any_use(&heights)
    };
    read.check_use(&path, &good).expect("its own heights");
    // Only cones over cells depend on what lies between the samples.
    let boxes = MapUse {
        patches: Patches::Boxes,
        ..good
    };
    read.check_use(&path, &boxes).expect("samples are samples");
    let walk = through(
        &made(&heights, MapKind::Walk),
        &MapFormat::new(Layout::Full),
    );

    let data = heights.data().to_vec();
    let unwrapped = Heights::new([12, 10], [false; 2], data.clone()).expect("heights");
    let mut touched = data;
    touched[77] = touched[77].next_down();
    let touched = Heights::new([12, 10], [true, false], touched).expect("heights");
    let turned = field([10, 12], [true, false]);
    let refuse = |file: &MapFile, wanted: &MapUse<'_>, words: &[&str]| {
        let why = file.check_use(&path, wanted).expect_err("a misfit");
        let why = why.to_string();
        assert!(why.contains("a.png") && !why.contains('\n'), "{why}");
        for word in words {
            assert!(why.contains(word), "`{word}` not in: {why}");
        }
    };
    let over = |heights| MapUse { heights, ..good };
    let kinds = &[MapKind::Walk, MapKind::WalkRelaxed];
    let words = ["`samples`", "csm-exact", "needs `walk` or `walk-relaxed`"];
    refuse(&read, &MapUse { kinds, ..good }, &words);
    let words = ["wrap along x", "wrap along none", "--wrap none"];
    refuse(&read, &over(&unwrapped), &words);
    refuse(&read, &over(&touched), &["other heights", "--invert"]);
    refuse(&read, &over(&turned), &["12 x 10", "10 x 12"]);
    let kinds = &[];
    let words = ["bilinear patches", "boxes"];
    refuse(&walk, &MapUse { kinds, ..boxes }, &words);
}

#[test]
fn a_map_goes_with_the_heights_in_its_own_file() {
    let heights = field([12, 10], [true, false]);
    for (kind, layout) in [
        (MapKind::Samples, Layout::Dummer),
        (MapKind::Samples, Layout::Pair),
        (MapKind::Relaxed, Layout::Relief),
    ] {
        let read = through(&made(&heights, kind), &eight(layout));
        let own = read.heights.clone().expect("heights");
        assert_ne!(own, heights.data(), "8 bits move them");
        let of = |wrap, z: &[f32]| Heights::new([12, 10], wrap, z.to_vec()).expect("heights");
        assert!(fits(&read, &heights), "the true ones");
        assert!(fits(&read, &of([true, false], &own)), "its own");
        // With one a little higher, or with another wrapping, they are others.
        assert!(!fits(&read, &of([false; 2], &own)));
        let mut touched = own;
        let low = touched.iter_mut().find(|z| **z < 1.0).expect("a height");
        *low = low.next_up();
        assert!(!fits(&read, &of([true, false], &touched)));
    }
    // A walk's file has the heights of cells, not of samples, even if they are as many.
    let heights = field([8, 8], [true; 2]);
    let walk = through(
        &made(&heights, MapKind::Walk),
        &MapFormat::new(Layout::Full),
    );
    let cells = walk.heights.clone().expect("heights");
    let cells = Heights::new([8, 8], [true; 2], cells).expect("heights");
    assert!(fits(&walk, &heights) && !fits(&walk, &cells));
}

#[test]
fn a_map_of_another_program_is_read_as_the_caller_says() {
    let folder = Folder::new();
    let heights = field([8, 8], [false; 2]);
    let ours = encoded(
        &made(&heights, MapKind::Samples),
        &MapFormat::new(Layout::Dummer),
    );
    let (_, rgba) = pixels(&ours);
    let write = |name: &str, size, color, samples: &[u8]| {
        folder.write(name, png(size, color, BitDepth::Eight, samples));
        folder.0.join(name)
    };
    let path = write("theirs.png", [8, 8], ColorType::Rgba, &rgba);
    assert!(!has_map(&path));
    let why = read_map(&path).expect_err("no label").to_string();
    assert!(
        why.contains("theirs.png") && why.contains("--from"),
        "{why}"
    );
    let foreign = ForeignFormat {
        layout: Layout::Dummer,
        ratio: RatioScale::Sqrt,
        wrap: [false; 2],
    };
    let read = decode(&path, Some(&foreign)).expect("a map");
    assert_eq!(read.map, decode_bytes(&ours).expect("a map").map);
    // Only its heights tell whose it is.
    let other = Pattern::Noise.heights([8, 8], 1, 0.0);
    let other = Heights::new([8, 8], [false; 2], other).expect("heights");
    assert!(fits(&read, &heights) && !fits(&read, &other));
    // A map has four channels.
    let three = write("three.png", [1, 1], ColorType::Rgb, &[1, 2, 3]);
    let why = decode(&three, Some(&foreign)).expect_err("three");
    assert!(why.to_string().contains("3 channels"), "{why}");
}

#[test]
fn a_map_that_was_cut_or_contradicts_itself_is_refused() {
    let folder = Folder::new();
    let heights = field([8, 8], [false; 2]);
    // A label of 8 x 8 samples on an image of 4 x 4.
    let mut cut = made(&heights, MapKind::Samples);
    cut.map.size = [4, 4];
    cut.map.ratios.truncate(16);
    cut.heights = cut.heights.map(|z| z[..16].to_vec());
    for layout in [Layout::Pair, Layout::Full] {
        let why = decode_bytes(&encoded(&cut, &MapFormat::new(layout))).expect_err("cut");
        assert!(why.contains("4 x 4") && why.contains("8 x 8"), "{why}");
    }
    folder.write("a.txt", "nothing");
    let why = read_map(&folder.0.join("a.txt"))
        .expect_err("no map")
        .to_string();
    assert!(why.contains("a.txt") && why.contains("PNG or EXR"), "{why}");
}

/// A PNG with another text in its label, which stands behind the pixels.
fn relabelled(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let (info, pixels) = pixels(bytes);
    let label = &info.uncompressed_latin1_text[0];
    assert!(label.text.contains(from), "{}", label.text);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, info.width, info.height);
    encoder.set_color(info.color_type);
    encoder.set_depth(info.bit_depth);
    let text = TEXtChunk::new(&label.keyword, label.text.replace(from, to));
    let mut writer = encoder.write_header().expect("a head");
    writer.write_image_data(&pixels).expect("pixels");
    writer.write_text_chunk(&text).expect("a text");
    writer.finish().expect("an end");
    bytes
}

#[test]
fn a_label_that_contradicts_its_file_is_refused() {
    let heights = field([8, 6], [false; 2]);
    let of = |kind, layout| encoded(&made(&heights, kind), &MapFormat::new(layout));
    let dummer = of(MapKind::Samples, Layout::Dummer);
    let quad = of(MapKind::Quad, Layout::Quad);
    let walk = of(MapKind::Walk, Layout::Pair);
    // The text of an EXR has no checksum.
    let mut floats = of(MapKind::Walk, Layout::Full);
    let at = floats.windows(6).position(|w| w == b"\"full\"");
    let at = at.expect("a layout");
    floats[at..at + 6].copy_from_slice(b"\"pair\"");
    let why = decode_bytes(&floats).expect_err("an EXR of numbers");
    assert!(why.contains("PNG") && why.contains("EXR"), "{why}");
    let later = "version = 2\nkind = \"new\"\nold";
    let from_cube = "from_ratio = \"cube\"\nslopes";
    let from_sqrt = "from_ratio = \"sqrt\"\nslopes";
    let with_slopes = "slopes = \"half\"\nsamples = ";
    for (bytes, from, to, word) in [
        (&dummer, "\"samples\"", "\"quad\"", "kind"),
        (&dummer, "\"samples\"", "\"walk\"", "kind"),
        (&dummer, "\"dummer\"", "\"quad\"", "layout quad"),
        (&quad, "\"quad\"\nlayout", "\"samples\"\nlayout", "kind"),
        (&dummer, "version = 1\nkind", later, "has version 2"),
        (&dummer, "scale = 8.0", "scale = 16.0", "scale"),
        (&dummer, "scale = 8.0", "scale = nan", "scale"),
        (&dummer, "\"whole\"", "\"most\"", "slopes"),
        (&dummer, "\"sqrt\"", "\"cube\"", "(ratio = \"cube\": "),
        (
            &dummer,
            "samples = ",
            "sample = ",
            "(missing field `samples`)",
        ),
        (&dummer, "slopes", from_cube, "from_ratio"),
        (&dummer, "slopes", from_sqrt, "from_ratio"),
        (&dummer, "offset = 0.0", "offset = 2.0", "offset"),
        (&dummer, "\"dummer\"\n", "\"full\"\n", "slopes"),
        (&quad, "layout = \"quad\"", "layout = \"full\"", "EXR"),
        (&quad, "samples = ", with_slopes, "slopes"),
        (&walk, "offset = 1.5", "offset = 0.0", "offset"),
    ] {
        decode_bytes(&relabelled(bytes, from, from)).expect("a map");
        let why = decode_bytes(&relabelled(bytes, from, to)).expect_err(to);
        assert!(why.contains(word) && !why.contains('\n'), "{why}");
    }
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
        let encoded = encode(&made(&heights, kind), &MapFormat::new(layout));
        let why = encoded.expect_err("no place");
        assert!(why.is_usage() && why.to_string().contains(words), "{why}");
    }
    // A map without heights cannot become one with them.
    let read = through(
        &made(&heights, MapKind::Quad),
        &MapFormat::new(Layout::Quad),
    );
    assert!(read.heights.is_none());
}
