//! Files of skies.

use std::fs;

use exr::math::Vec2;
use exr::prelude::{
    Encoding, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes, SpecificChannels,
    WritableImage,
};

use crate::folder::Folder;
use crate::images::pixels;

/// A Radiance HDR of one colour.
pub fn even([w, h]: [u32; 2]) -> Vec<u8> {
    let head = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {h} +X {w}\n");
    let texels = [128, 64, 32, 129].repeat((w * h) as usize);
    [head.into_bytes(), texels].concat()
}

/// The same with more lines in its head.
fn exposed([w, h]: [u32; 2], lines: &str) -> Vec<u8> {
    let more = format!("RADIANCE\n{lines}\n");
    swapped(&even([w, h]), "RADIANCE\n", &more)
}

/// Bytes with a word in place of another one.
fn swapped(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let mut places = bytes.windows(from.len());
    let at = places.position(|w| w == from.as_bytes()).expect("the word");
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

/// An OpenEXR that holds a quarter of its picture.
fn cropped() -> Vec<u8> {
    let light = SpecificChannels::rgb(uneven);
    let layer = Layer::new(
        (8, 4),
        LayerAttributes::named("light"),
        Encoding::default(),
        light,
    );
    let whole = IntegerBounds::from_dimensions((16, 8));
    let image = Image::empty(ImageAttributes::new(whole)).with_layer(layer);
    let mut file = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).expect("a file");
    file.into_inner()
}

/// An OpenEXR with luminance alone.
fn grey() -> Vec<u8> {
    let light = SpecificChannels::build()
        .with_channel("Y")
        .with_pixel_fn(|_| (0.5_f32,));
    let image = Image::from_channels((8, 4), light);
    let mut file = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).expect("a file");
    file.into_inner()
}

/// An OpenEXR with one odd number.
fn with_red(red: f32) -> Vec<u8> {
    let light = |at: Vec2<usize>| match (at.x(), at.y()) {
        (3, 1) => (red, 1.0, 1.0),
        _ => (1.0_f32, 1.0_f32, 1.0_f32),
    };
    let image = Image::from_channels((8, 4), SpecificChannels::rgb(light));
    let mut file = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).expect("a file");
    file.into_inner()
}

/// Light that differs along both axes.
fn uneven(at: Vec2<usize>) -> (f32, f32, f32) {
    (1.0, at.x() as f32 / 8.0, at.y() as f32 / 4.0)
}

/// An OpenEXR whose first part has a channel of another kind and size.
fn behind_a_mask() -> Vec<u8> {
    let mask = SpecificChannels::build()
        .with_channel("mask")
        .with_pixel_fn(|_| (0.5_f32,));
    let light = SpecificChannels::rgb(uneven);
    let layer = |name: &str| LayerAttributes::named(name);
    let image = Image::empty(ImageAttributes::new(IntegerBounds::from_dimensions((8, 4))))
        .with_layer(Layer::new((4, 2), layer("mask"), Encoding::default(), mask))
        .with_layer(Layer::new(
            (8, 4),
            layer("light"),
            Encoding::default(),
            light,
        ));
    let mut file = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).expect("a file");
    file.into_inner()
}

const RENDER: &str = "render mandelbox --size 32x18 --set look.sky_file";

#[test]
fn a_sky_that_cannot_be_read_is_named() {
    let folder = Folder::new();
    let whole = even([16, 8]);
    folder.write("cut.hdr", &whole[..whole.len() - 9]);
    folder.write("wide.hdr", even([16, 4]));
    folder.write("empty.hdr", "");
    folder.write("text.hdr", "no light at all");
    let whole = with_red(1.0);
    folder.write("cut.exr", &whole[..whole.len() - 9]);
    folder.write("head.exr", &whole[..60]);
    folder.write("dark.exr", with_red(-0.5));
    folder.write("endless.exr", with_red(f32::INFINITY));
    folder.write("nothing.exr", with_red(f32::NAN));
    folder.write("bright.exr", with_red(3e38));
    folder.write("part.exr", cropped());
    folder.write("grey.exr", grey());
    folder.write("unexposed.hdr", exposed([16, 8], "EXPOSURE=0"));
    folder.write("odd.hdr", exposed([16, 8], "COLORCORR=1 nan 1"));
    folder.write("xyz.hdr", swapped(&even([16, 8]), "rgbe", "xyze"));
    folder.write("turned.hdr", swapped(&even([16, 8]), "-Y", "+Y"));
    folder.write(
        "large.hdr",
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 200000\n",
    );
    for (name, why) in [
        ("none.hdr", "cannot be read"),
        ("cut.hdr", "fetch or save it again"),
        (
            "wide.hdr",
            "is 16 x 4, and a whole sky is twice as wide as high",
        ),
        ("empty.hdr", "is empty"),
        ("text.hdr", "is no Radiance HDR and no OpenEXR"),
        (
            "cut.exr",
            "is an EXR that cannot be read|fetch or save it again",
        ),
        (
            "head.exr",
            "is an EXR that cannot be read|fetch or save it again",
        ),
        ("dark.exr", "-0.5|column 3, row 1"),
        ("endless.exr", "inf|column 3, row 1"),
        ("nothing.exr", "NaN|column 3, row 1"),
        ("bright.exr", "3e38|column 3, row 1|from 0 to 1e8"),
        ("large.hdr", "8192"),
        (
            "part.exr",
            "with 8 x 4 pixels of a picture of 16 x 8|save the whole",
        ),
        ("grey.exr", "without channels R, G and B"),
        ("unexposed.hdr", "EXPOSURE|come to 0;|above 0"),
        ("odd.hdr", "COLORCORR|come to NaN;"),
        ("xyz.hdr", "is an HDR that cannot be read|save it as RGB"),
        (
            "turned.hdr",
            "is an HDR that cannot be read|from the upper left",
        ),
    ] {
        folder.fails(
            &format!("{RENDER}={name}"),
            2,
            &format!("sky_file|{name}|{why}"),
        );
        assert!(!folder.files().iter().any(|file| file.ends_with(".png")));
    }
}

/// Exposures tell what the pixels were multiplied by, and each line counts.
#[test]
fn the_light_of_an_hdr_is_divided_by_its_exposures() {
    let folder = Folder::new();
    folder.write("a.hdr", even([16, 8]));
    folder.write(
        "b.hdr",
        exposed([16, 8], "EXPOSURE=8\nEXPOSURE=0.5\nCOLORCORR=0.5 0.5 0.5"),
    );
    let shown = ["a.hdr", "b.hdr"].map(|file| {
        let strength = if file == "b.hdr" { 2 } else { 1 };
        let line = format!("{RENDER}={file} --set look.sky_strength={strength} -o a.png");
        folder.done(&line);
        pixels(folder.bytes("a.png")).1
    });
    assert!(shown[0] == shown[1]);
}

#[test]
fn a_sky_may_follow_other_parts() {
    let folder = Folder::new();
    folder.write("two.exr", behind_a_mask());
    let mut file = std::io::Cursor::new(Vec::new());
    let one = Image::from_channels((8, 4), SpecificChannels::rgb(uneven));
    one.write().to_buffered(&mut file).expect("a file");
    folder.write("one.exr", file.into_inner());
    let shown = ["two.exr", "one.exr"].map(|file| {
        folder.done(&format!("{RENDER}={file} -o a.png"));
        pixels(folder.bytes("a.png")).1
    });
    assert!(shown[0] == shown[1]);
}

#[test]
fn a_picture_is_the_sky_of_another() {
    let folder = Folder::new();
    folder
        .done("render valley-mist --size 64x32 --set camera.projection=equirectangular -o sky.exr");
    // A preset names the file beside it.
    fs::create_dir(folder.0.join("sub")).unwrap();
    fs::rename(folder.0.join("sky.exr"), folder.0.join("sub/sky.exr")).unwrap();
    let preset =
        "[scene]\nkind = \"distance\"\nformula = \"mandelbox\"\n[look]\nsky_file = \"sky.exr\"\n";
    folder.write("sub/own.toml", preset);
    for device in ["auto", "cpu"] {
        let shown = ["sky.exr", "none"].map(|file| {
            folder.done(&format!(
                "render sub/own.toml --device {device} --size 32x18 -o a.png --set look.sky_file={file}"
            ));
            pixels(folder.bytes("a.png")).1
        });
        assert_ne!(shown[0], shown[1]);
    }
    // Nothing is written over the sky.
    folder.fails(
        "render sub/own.toml --size 32x18 -o sub/sky.exr",
        2,
        "sky.exr",
    );
}
