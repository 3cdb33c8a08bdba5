//! What is in the files: layers, bits, channels and text.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Layer};
use png::text_metadata::{ITXtChunk, TEXtChunk, ZTXtChunk};

use crate::folder::{Folder, holds};
use crate::images::pixels;
use crate::tools::{rendered, tiny};

fn picture(folder: &Folder, more: &str) -> (png::Info<'static>, Vec<u8>) {
    rendered(folder, "mandelbox", &format!("{more} -o l.png"));
    pixels(folder.bytes("l.png"))
}

#[test]
fn layers_and_depths_are_what_they_say() {
    let folder = Folder::new();
    let (_, color) = picture(&folder, "");
    for layer in ["depth", "normal", "position", "steps", "state"] {
        for (bits, bytes) in [("8", 1), ("16", 2)] {
            let (info, pixels) = picture(&folder, &format!("--layer {layer} --depth {bits}"));
            // Colours are sRGB, data are not.
            assert!(info.srgb.is_none(), "{layer}");
            let channels = if layer == "depth" { 1 } else { 3 };
            assert_eq!(pixels.len(), 24 * 16 * channels * bytes, "{layer} {bits}");
            assert_ne!(pixels, color, "{layer} shows colour");
            if layer == "depth" {
                // The box does not reach the corner: sky, which is white.
                assert!(pixels[..bytes].iter().all(|b| *b == 255));
                assert!(pixels.chunks(bytes).any(|p| p.iter().all(|b| *b == 0)));
            }
            if layer == "state" && bytes == 1 {
                assert_eq!(pixels[..3], [23, 38, 77], "sky is dark blue");
            }
        }
    }
    // 16 bits are more than 8 bits twice.
    let (info, deep) = picture(&folder, "--depth 16");
    assert!(info.srgb.is_some());
    assert!(deep.chunks(2).any(|p| p[0] != p[1]));
    let pairs = deep.chunks(2).zip(&color);
    let off = pairs.filter(|(d, c)| d[0].abs_diff(**c) > 1);
    assert_eq!(off.count(), 0, "8 and 16 bits show different pictures");
}

#[test]
fn a_png_tells_its_title_program_and_preset_in_chunks_that_all_programs_read() {
    let folder = Folder::new();
    let info = picture(&folder, "--set title=Box").0;
    let text = |keyword: &str| {
        let mut chunks = info.uncompressed_latin1_text.iter();
        let found = chunks.find(|c| c.keyword == keyword);
        found.map(|c| c.text.as_str()).unwrap_or_default()
    };
    assert_eq!(text("Title"), "Box");
    let program = concat!("conemarch ", env!("CARGO_PKG_VERSION"));
    assert_eq!(text("Software"), program);
    assert!(text("conemarch preset").contains("title = \"Box\""));
    assert!(info.utf8_text.is_empty());
    // Other letters need the other chunk.
    let info = picture(&folder, "--set title=Würfel").0;
    let unicode: Vec<&str> = info.utf8_text.iter().map(|c| c.keyword.as_str()).collect();
    assert_eq!(unicode, ["Title", "conemarch preset"]);
    // The crate of EXR takes texts for Latin-1.
    rendered(&folder, "mandelbox", "--set title=Würfel -o w.exr");
    let printed = folder.done("presets w.exr").stdout;
    holds(&String::from_utf8_lossy(&printed), &["title = \"Würfel\""]);
    folder.done("render l.png --explain");
}

#[test]
fn files_tell_their_title_and_density() {
    let folder = Folder::new();
    assert!(picture(&folder, "").0.pixel_dims.is_none());
    let set = "--set image.ppi=300";
    let there = picture(&folder, set).0.pixel_dims.expect("a pHYs chunk");
    // 300 to 25.4 mm.
    assert_eq!(
        (there.xppu, there.yppu, there.unit),
        (11811, 11811, png::Unit::Meter)
    );
    rendered(&folder, "mandelbox", &format!("{set} -o a.jpg"));
    // JFIF: the unit is inches, and then two densities.
    assert_eq!(folder.bytes("a.jpg")[13..18], [1, 1, 44, 1, 44]);
    rendered(&folder, "mandelbox", &format!("{set} -o a.exr"));
    let own = exr_layer(&folder.0.join("a.exr")).attributes;
    assert_eq!(own.horizontal_density, Some(300.0));
    assert!(own.comments.unwrap() == *"Mandelbox, scale 2, pale stone from below");
    rendered(&folder, "mandelbox", &format!("{set} -o a.webp"));
    for name in ["a.jpg", "a.webp"] {
        let mut bytes = Cursor::new(folder.bytes(name));
        let told = exif::Reader::new().read_from_container(&mut bytes).unwrap();
        let value = |tag| {
            told.get_field(tag, exif::In::PRIMARY)
                .unwrap()
                .display_value()
        };
        let title = value(exif::Tag::ImageDescription).to_string();
        assert_eq!(
            title, "\"Mandelbox, scale 2, pale stone from below\"",
            "{name}"
        );
        let program = value(exif::Tag::Software).to_string();
        assert!(program.starts_with("\"conemarch "), "{name}: {program}");
        assert_eq!(value(exif::Tag::XResolution).to_string(), "300", "{name}");
        assert_eq!(value(exif::Tag::ColorSpace).to_string(), "sRGB", "{name}");
    }
    folder.fails(
        "render mandelbox --set image.ppi=0",
        2,
        "image.ppi|1 to 10000",
    );
}

/// A picture of another program, with chunks behind the pixels and much else.
fn foreign(fill: impl FnOnce(&mut png::Writer<&mut Vec<u8>>)) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&[7]).expect("a pixel");
    let other = png::chunk::ChunkType(*b"miNe");
    writer.write_chunk(other, &vec![0; 5 << 20]).expect("zeros");
    fill(&mut writer);
    writer.finish().expect("an end");
    bytes
}

#[test]
fn a_preset_is_read_from_any_kind_of_text_chunk() {
    let folder = Folder::new();
    let key = || "conemarch preset".to_string();
    let text = "[scene]\nkind = \"slab\"\n";
    let plain = |text: &str| {
        let chunk = TEXtChunk::new(key(), text);
        foreign(|w| w.write_text_chunk(&chunk).unwrap())
    };
    for bytes in [
        plain(text),
        foreign(|w| w.write_text_chunk(&ZTXtChunk::new(key(), text)).unwrap()),
        foreign(|w| w.write_text_chunk(&ITXtChunk::new(key(), text)).unwrap()),
    ] {
        folder.write("a.png", bytes);
        folder.done("render a.png --explain");
    }
    folder.write("bad.png", plain("[scene]\nkind = 3\n"));
    folder.fails("presets bad.png", 1, "bad.png:2: scene.kind = 3: must be");
    folder.write("none.png", foreign(|_| {}));
    folder.write("not.png", b"\x89PNG\r\n\x1a\nnonsense");
    folder.fails(&tiny("none.png", ""), 1, "none.png: carries no preset");
    folder.fails(&tiny("not.png", ""), 1, "not.png: is a broken PNG");
}

#[test]
fn jpeg_and_webp_show_the_picture() {
    let folder = Folder::new();
    let (_, png) = picture(&folder, "");
    rendered(&folder, "mandelbox", "-o a.webp");
    let webp = image::load_from_memory(&folder.bytes("a.webp")).expect("a WebP");
    assert_eq!(webp.into_rgb8().into_raw(), png, "WebP is without loss");
    let jpeg = |more: &str| {
        rendered(&folder, "mandelbox", more);
        let bytes = folder.bytes("a.jpg");
        let picture = image::load_from_memory(&bytes).expect("a JPEG").into_rgb8();
        let pairs = picture.iter().zip(&png);
        let off: f64 = pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
        (bytes.len(), off / png.len() as f64)
    };
    let (usual, off) = jpeg("-o a.jpg");
    assert!(off > 0.0 && off < 6.0, "{off}");
    assert_eq!(jpeg("-o a.jpg --quality 92").0, usual);
    let (small, worse) = jpeg("-o a.jpg --quality 20");
    let worth = small < usual && worse > off;
    assert!(worth, "{small} {usual} {worse} {off}");
    // A layer of one channel.
    rendered(&folder, "mandelbox", "-o d.jpeg --layer depth");
    let depth = image::load_from_memory(&folder.bytes("d.jpeg")).expect("a JPEG");
    assert_eq!(depth.color(), image::ColorType::L8);
}

pub fn exr_layer(path: &Path) -> Layer<AnyChannels<FlatSamples>> {
    exr::prelude::read_first_flat_layer_from_file(path)
        .expect("an EXR")
        .layer_data
}

pub fn values(layer: &Layer<AnyChannels<FlatSamples>>, name: &str) -> Vec<f32> {
    let mut list = layer.channel_data.list.iter();
    let channel = list.find(|c| c.name.to_string() == name).expect(name);
    channel.sample_data.values_as_f32().collect()
}

#[test]
fn an_exr_has_exactly_the_promised_channels() {
    let folder = Folder::new();
    let promised =
        "A B G R Z depth.Z normal.X normal.Y normal.Z position.X position.Y position.Z state.Y";
    for (more, last) in [
        ("-o a.exr --samples 1", ""),
        ("-o b.exr --samples 1 --stats s.json", " steps.Y"),
        ("-o c.exr --samples 2", " variance.Y"),
    ] {
        rendered(&folder, "mandelbox", more);
        let layer = exr_layer(&folder.0.join(&more[3..8]));
        let list = &layer.channel_data.list;
        let float = |c: &AnyChannel<_>| matches!(c.sample_data, FlatSamples::F32(_));
        assert!(list.iter().all(float));
        let names: Vec<String> = list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names.join(" "), format!("{promised}{last}"));
    }
    let layer = exr_layer(&folder.0.join("a.exr"));
    let of = |name: &str| values(&layer, name);
    let (depth, planar, state) = (of("depth.Z"), of("Z"), of("state.Y"));
    assert_eq!(depth.len(), 24 * 16);
    assert!(of("A").iter().all(|a| *a == 1.0));
    for ((t, z), s) in depth.iter().zip(&planar).zip(&state) {
        let far = [*t, *z].map(|x| x == 1e10);
        assert_eq!(far, [*s == 0.0; 2], "depth {t} {z}, state {s}");
    }
    assert!(state.contains(&1.0) && state.contains(&0.0));
    // Both are the same on the axis, and the planar one is shorter beside it: by the ray's
    // angle to the view, which positions tell too.
    let forward = [-3.84_f32, 9.6, 11.84].map(|x| x / 247.0912_f32.sqrt());
    let position = ["X", "Y", "Z"].map(|x| of(&format!("position.{x}")));
    let eye = [8.0, -11.0, -8.0];
    let mut shorter = 0;
    for i in (0..state.len()).filter(|i| state[*i] == 1.0) {
        let along: f32 = (0..3).map(|a| (position[a][i] - eye[a]) * forward[a]).sum();
        let off = (along - planar[i]).abs();
        assert!(off < 1e-4 * along, "{along} {}", planar[i]);
        assert!(planar[i] <= depth[i]);
        shorter += usize::from(planar[i] < 0.999 * depth[i]);
    }
    assert!(shorter > 0);
}

/// Grey is the share of the samples, or the standard error, which is white from 0.1 on.
#[test]
fn samples_and_variance_are_shown_as_an_exr_has_them() {
    let folder = Folder::new();
    let shown = |layer: &str, more: &str, share: fn(f64) -> f64| {
        let line = format!("render mandelbox --device cpu {more}");
        folder.done(&format!("{line} --layer {layer} -o a.png"));
        folder.done(&format!("{line} -o a.exr"));
        let (info, grey) = pixels(folder.bytes("a.png"));
        assert_eq!(info.color_type, png::ColorType::Grayscale, "{layer}");
        assert!(info.srgb.is_none(), "{layer}");
        let own = values(&exr_layer(&folder.0.join("a.exr")), &format!("{layer}.Y"));
        let level = |x: &f32| (255.0 * share(f64::from(*x)).min(1.0)).round() as u8;
        let wanted: Vec<u8> = own.iter().map(level).collect();
        assert!(grey == wanted, "{layer}");
        own
    };
    // Some tiles end with half of the samples.
    let some = "--size 150x139 --samples 16 --until 0.04";
    let counts = shown("samples", some, |n| n / 16.0);
    assert!([8.0, 16.0].iter().all(|n| counts.contains(n)));
    let (_, all) = picture(&folder, "--layer samples --samples 2");
    assert_eq!(all, [255; 24 * 16]);
    // A sky of one colour, and no sun.
    let even = "--set look.sky_low=[0.5,0.5,0.5] --set look.sky_high=[0.5,0.5,0.5] --set look.light_color=[0,0,0]";
    let more = format!("--size 24x16 --samples 8 {even}");
    let variances = shown("variance", &more, |v| v.sqrt() / 0.1);
    assert!(variances[0] < 1e-12, "sky: {}", variances[0]);
    assert!(variances.iter().any(|v| *v > 1e-5));
}

#[test]
fn an_exr_tells_where_it_comes_from_and_is_the_same_every_time() {
    let folder = Folder::new();
    for name in ["a.exr", "b.exr"] {
        rendered(&folder, "mandelbox", &format!("-o {name}"));
    }
    let bytes = folder.bytes("a.exr");
    assert!(bytes == folder.bytes("b.exr"), "two runs differ");
    let image = exr::prelude::read_first_flat_layer_from_file(folder.0.join("a.exr"));
    let image = image.expect("an EXR");
    let software = image.layer_data.attributes.software_name.expect("a name");
    assert!(software.to_string().starts_with("conemarch "));
    let colors = image.attributes.chromaticities.expect("chromaticities");
    let colors = [colors.red.0, colors.green.1, colors.white.0];
    assert_eq!(colors, [0.64, 0.60, 0.3127]);
    assert_eq!(image.attributes.pixel_aspect, 1.0);
    let texts = image.layer_data.attributes.other.into_iter();
    let texts = texts.chain(image.attributes.other);
    let texts: Vec<(String, String)> = texts
        .map(|(name, value)| (name.to_string(), value.into_text().unwrap().to_string()))
        .collect();
    let text = |name: &str| &texts.iter().find(|(n, _)| n == name).expect(name).1;
    assert!(text("conemarch camera").starts_with("eye = [8.0, -11.0, -8.0]\ntarget = "));
    folder.write("again.toml", text("conemarch preset"));
    rendered(&folder, "again.toml", "-o c.exr");
    let again = bytes == folder.bytes("c.exr");
    assert!(again, "its preset makes another picture");
}

#[test]
fn errors_are_a_layer() {
    let folder = Folder::new();
    // Nothing of the truth is too deep; red says that much of the slides' picture is.
    let red = |mode: &str| {
        let more = format!("--layer error --set march.mode={mode} -o e.png");
        let said = rendered(&folder, "bench-thin", &more);
        let at = |word: &str| said.find(word).unwrap_or(usize::MAX);
        assert!(at("the truth, a slow reference") < at("e.png"), "{said}");
        let (_, pixels) = pixels(folder.bytes("e.png"));
        fs::remove_file(folder.0.join("e.png")).unwrap();
        let red = |c: &&[u8]| c[0] > c[2].saturating_add(150);
        pixels.chunks(3).filter(red).count()
    };
    assert_eq!(red("truth"), 0);
    assert!(red("slides-fast") > 10);
}
