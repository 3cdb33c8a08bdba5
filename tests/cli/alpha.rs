//! Files over a transparent background.

use conemarch::pass::tone_map::Tone;
use glam::DVec3;

use crate::folder::Folder;
use crate::images::pixels;
use crate::pictures::{exr_layer, values};

/// A picture with sky, edges, and sides that are no multiples of anything.
const PICTURE: &str = "mandelbox --device cpu --size 90x139 --samples 3 --set look.shadow=false --set image.background=transparent";

#[test]
fn png_and_webp_are_straight_and_exr_is_premultiplied() {
    let folder = Folder::new();
    for (file, more) in [
        ("a.exr", ""),
        ("8.png", ""),
        ("16.png", "--depth 16"),
        ("a.webp", ""),
    ] {
        folder.done(&format!("render {PICTURE} -o {file} {more}"));
    }
    let layer = exr_layer(&folder.0.join("a.exr"));
    let [r, g, b, a] = ["R", "G", "B", "A"].map(|name| values(&layer, name));
    let (eight, bytes) = pixels(folder.bytes("8.png"));
    let (sixteen, wide) = pixels(folder.bytes("16.png"));
    assert_eq!(
        [eight.color_type, sixteen.color_type],
        [png::ColorType::Rgba; 2]
    );
    let plan = conemarch::preset::load("mandelbox", &[])
        .expect("built in")
        .plan;
    let tone = Tone::of(&plan.look);
    let mut seen = [0; 3];
    for (i, alpha) in a.iter().enumerate() {
        seen[(alpha * 3.0).round() as usize % 3] += 1;
        let light = DVec3::from([r[i], g[i], b[i]].map(f64::from));
        // The colour of the hits alone, and then their share.
        let straight = match *alpha > 0.0 {
            true => tone.shown(light / f64::from(*alpha)),
            false => DVec3::ZERO,
        };
        let [x, y, z] = straight.to_array();
        for (c, value) in [x, y, z, f64::from(*alpha)].into_iter().enumerate() {
            let at = 4 * i + c;
            let found = u16::from_be_bytes([wide[2 * at], wide[2 * at + 1]]);
            assert!((f64::from(found) - 65535.0 * value).abs() <= 0.6, "{i} {c}");
            assert!(
                (f64::from(bytes[at]) - 255.0 * value).abs() <= 1.1,
                "{i} {c}"
            );
        }
        assert_eq!(bytes[4 * i + 3], (255.0 * alpha).round() as u8);
        assert!(*alpha > 0.0 || (light == DVec3::ZERO && bytes[4 * i..][..4] == [0; 4]));
    }
    assert!(seen.iter().all(|n| *n > 20), "{seen:?}");
    let webp = image::load_from_memory(&folder.bytes("a.webp")).expect("a WebP");
    assert_eq!(webp.color(), image::ColorType::Rgba8);
    assert!(webp.into_rgba8().into_raw() == bytes);
}

#[test]
fn bands_and_parts_have_the_bytes_of_the_picture_made_at_once() {
    let folder = Folder::new();
    for part in ["0,0", "0,1", "1,0", "1,1"] {
        let name = part.replace(',', "");
        folder.done(&format!(
            "render {PICTURE} --tile {part}/2x2 -o p{name}.exr"
        ));
    }
    for (file, more) in [
        ("png", ""),
        ("png", "--depth 16"),
        ("webp", ""),
        ("exr", ""),
    ] {
        folder.done(&format!("render {PICTURE} -o a.{file} {more}"));
        let whole = folder.bytes(&format!("a.{file}"));
        folder.done(&format!(
            "merge p00.exr p01.exr p10.exr p11.exr -o m.{file} {more}"
        ));
        assert!(
            folder.bytes(&format!("m.{file}")) == whole,
            "merge {file} {more}"
        );
        if file != "webp" {
            folder.done(&format!("render {PICTURE} -o b.{file} --resume {more}"));
            assert!(
                folder.bytes(&format!("b.{file}")) == whole,
                "bands {file} {more}"
            );
        }
    }
    folder.fails(
        "merge p00.exr p01.exr p10.exr p11.exr -o m.jpg",
        2,
        "alpha|PNG, WebP or EXR",
    );
}

#[test]
fn what_has_no_alpha_is_refused_and_other_layers_are_as_before() {
    let folder = Folder::new();
    let says = "a JPEG has no alpha|PNG, WebP or EXR|image.background=sky";
    folder.fails(&format!("render {PICTURE} -o a.jpg"), 2, says);
    for layer in ["normal", "state"] {
        let line = format!("render {PICTURE} --layer {layer} -o");
        folder.done(&format!("{line} a.jpg"));
        folder.done(&format!("{line} a.png"));
        let (info, clear) = pixels(folder.bytes("a.png"));
        assert_eq!(info.color_type, png::ColorType::Rgb);
        folder.done(&format!("{line} b.png --set image.background=sky"));
        assert!(pixels(folder.bytes("b.png")).1 == clear, "{layer}");
    }
    folder.write(
        "film.toml",
        "[scene]\nkind = \"slab\"\n[image]\nbackground = \"transparent\"\n[[track]]\nkey = \"camera.fov\"\nkeys = [[0, 40.0], [1, 50.0]]\n",
    );
    let line = "animate film.toml -o f-%03d.png --video f.mp4 --device cpu";
    folder.fails(line, 2, "--video has no alpha|image.background=sky");
}
