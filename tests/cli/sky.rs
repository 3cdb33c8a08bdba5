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
    ] {
        folder.fails(
            &format!("{RENDER}={name}"),
            2,
            &format!("sky_file|{name}|{why}"),
        );
        assert!(!folder.files().iter().any(|file| file.ends_with(".png")));
    }
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
