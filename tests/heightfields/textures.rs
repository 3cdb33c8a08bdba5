//! Pictures over height surfaces: where their texels lie, on both executors, and which files are
//! refused.

use conemarch::base::srgb::linear;
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::texture::Texture;
use conemarch::plan::{Extras, Plan};
use conemarch::scene::Assets;
use glam::DVec3;
use image::{ExtendedColorType, ImageFormat};
use png::{BitDepth, ColorType};

use crate::cases::surface;
use crate::common::folder::{Folder, holds, said, text};
use crate::common::pictures::png;
use crate::{apart, both, camera};

/// Six columns and four rows, no two texels alike.
const SIZE: [u32; 2] = [6, 4];

fn texels() -> Vec<u8> {
    let numbers = 0..SIZE[0] * SIZE[1] * 3;
    numbers.map(|i| (i * 79 % 251) as u8).collect()
}

/// The linear colour of a texel.
fn texel(x: u32, y: u32) -> DVec3 {
    let own = &texels()[3 * (y * SIZE[0] + x) as usize..][..3];
    linear(DVec3::new(own[0].into(), own[1].into(), own[2].into()) / 255.0)
}

fn written(folder: &Folder) -> Texture {
    let bytes = png(SIZE, ColorType::Rgb, BitDepth::Eight, &texels());
    folder.write("t.png", bytes);
    Texture::read(&folder.0.join("t.png")).unwrap()
}

fn flat(size: [u32; 2], wrap: bool, patches: Patches, tiles: [u32; 2]) -> HeightSurface {
    let heights = vec![0.5; (size[0] * size[1]) as usize];
    HeightSurface::clone(&surface((size, [wrap; 2], tiles, patches), heights))
}

#[test]
fn a_texel_lies_on_each_sample_of_a_map_of_the_same_size() {
    let folder = Folder::new();
    let texture = written(&folder);
    let same = |surface: &HeightSurface, cell, uv, wanted: DVec3| {
        let own = texture.at(surface, cell, uv);
        let right = own.abs_diff_eq(wanted, 1e-12);
        assert!(right, "{cell:?} {uv:?}: {own} {wanted}");
    };
    // Patches have samples at their corners; tiles and borders come round.
    let tiled = flat(SIZE, true, Patches::Bilinear, [2, 3]);
    for (x, y) in (0..4 * 3).flat_map(|y| (0..6 * 2).map(move |x| (x, y))) {
        let [i, j] = [x as u32 % 6, y as u32 % 4];
        same(&tiled, [x, y], [0.0, 0.0], texel(i, j));
        let next = texel((i + 1) % 6, (j + 1) % 4);
        same(&tiled, [x, y], [1.0, 1.0], next);
        let across = texel(i, j).lerp(texel((i + 1) % 6, j), 0.25);
        same(&tiled, [x, y], [0.25, 0.0], across);
    }
    // Without wrapping the last cell ends at the last sample.
    let ended = flat(SIZE, false, Patches::Bilinear, [1, 1]);
    same(&ended, [4, 2], [1.0, 1.0], texel(5, 3));
    same(&ended, [0, 0], [0.0, 1.0], texel(0, 1));
    // A box is a sample, whose texel lies on its middle; its outer half keeps that colour.
    let boxes = flat(SIZE, false, Patches::Boxes, [1, 1]);
    same(&boxes, [2, 3], [0.5, 0.5], texel(2, 3));
    same(&boxes, [5, 3], [0.9, 0.75], texel(5, 3));
    // The one cell of a single sample shows the whole picture, and so does one row of it.
    let single = flat([1, 1], false, Patches::Bilinear, [1, 1]);
    same(&single, [0, 0], [1.5 / 6.0, 2.5 / 4.0], texel(1, 2));
    let row = flat([1, 4], false, Patches::Bilinear, [1, 1]);
    same(&row, [0, 2], [5.5 / 6.0, 0.0], texel(5, 2));
    // Of another size it is stretched: each of these boxes is two texels by one.
    let wide = flat([3, 4], false, Patches::Boxes, [1, 1]);
    same(&wide, [1, 2], [0.25, 0.5], texel(2, 2));
    same(&wide, [1, 2], [0.75, 0.5], texel(3, 2));
}

#[test]
fn grey_and_sixteen_bits_are_read() {
    let folder = Folder::new();
    let one = flat([1, 1], false, Patches::Boxes, [1, 1]);
    use BitDepth::{Eight, Sixteen};
    use ColorType::{Grayscale, GrayscaleAlpha, Rgb, Rgba};
    type Row<'a> = (ColorType, BitDepth, &'a [u8], [f64; 3], bool);
    // 0x6400 of 65535 is 99.6 of 255, and 0x8080 is exactly 128.
    let deep = &[0x64, 0, 0xff, 0xff, 0, 0];
    let clear = &[0, 0, 0, 0, 0xff, 0xff, 0xff, 0xfe];
    let rows: [Row; 7] = [
        (Grayscale, Eight, &[100], [100.0; 3], false),
        (GrayscaleAlpha, Eight, &[100, 7], [100.0; 3], true),
        (Rgb, Sixteen, deep, [100.0, 255.0, 0.0], false),
        (Grayscale, Sixteen, &[0x80, 0x80], [128.0; 3], false),
        (Rgba, Sixteen, clear, [0.0, 0.0, 255.0], true),
        (Rgba, Eight, &[1, 2, 3, 254], [1.0, 2.0, 3.0], true),
        // Alpha that hides nothing.
        (Rgba, Eight, &[1, 2, 3, 255], [1.0, 2.0, 3.0], false),
    ];
    for (color, depth, bytes, wanted, transparent) in rows {
        folder.write("one.png", png([1, 1], color, depth, bytes));
        let texture = Texture::read(&folder.0.join("one.png")).unwrap();
        let own = texture.at(&one, [0, 0], [0.5, 0.5]);
        let wanted = linear(DVec3::from(wanted) / 255.0);
        assert!(own.abs_diff_eq(wanted, 1e-12), "{bytes:?}: {own}");
        assert_eq!(texture.note().is_some(), transparent, "{bytes:?}");
    }
}

#[test]
fn jpeg_and_webp_are_read_by_their_content() {
    let folder = Folder::new();
    let of_png = written(&folder);
    let save = |name: &str, format| {
        let path = folder.0.join(name);
        let rgb = ExtendedColorType::Rgb8;
        image::save_buffer_with_format(&path, &texels(), SIZE[0], SIZE[1], rgb, format).unwrap();
        Texture::read(&path).unwrap()
    };
    // WebP without loss has the same texels, whatever the file is called.
    assert_eq!(save("t", ImageFormat::WebP), of_png);
    // JPEG loses a little: a flat colour stays within 2 of 255.
    let flat = [200, 120, 40].repeat(64);
    let path = folder.0.join("flat.png");
    let rgb = ExtendedColorType::Rgb8;
    image::save_buffer_with_format(&path, &flat, 8, 8, rgb, ImageFormat::Jpeg).unwrap();
    let bytes = Texture::read(&path).unwrap().bytes();
    for texel in bytes[8..].chunks_exact(4) {
        let near = |(a, b): (&u8, &u8)| a.abs_diff(*b) <= 2;
        let mut pairs = texel.iter().zip(&[200, 120, 40, 255]);
        assert!(pairs.all(near), "{texel:?}");
    }
    for (name, whole) in [("a.jpg", "flat.png"), ("a.webp", "t")] {
        folder.write(name, &folder.bytes(whole)[..40]);
        let why = Texture::read(&folder.0.join(name)).unwrap_err();
        assert!(why.contains(name) && why.contains("save it again"), "{why}");
    }
}

/// A plan of a small map of noise with a texture.
fn plan(texture: &str, wrap: &str, surface: &str) -> Plan {
    let tiles = if wrap == "xy" { [2, 1] } else { [1, 1] };
    let mut plan = crate::plan(&format!(
        "field = 'noise:7x5,seed=3'\nwrap = '{wrap}'\ntiles = {tiles:?}\nsurface = '{surface}'
        texture = '{texture}'"
    ));
    plan.camera = camera([3.0, -9.0, 9.0], [0.0; 3], 40.0);
    plan
}

#[test]
fn both_executors_color_alike_and_by_the_texture() {
    let folder = Folder::new();
    written(&folder);
    let file = folder.0.join("t.png").display().to_string();
    for wrap in ["none", "xy"] {
        for surface in ["bilinear", "boxes"] {
            let [here, there] = both(&plan(&file, wrap, surface), Extras::default());
            let wrong = apart(&here, &there, 0.01);
            assert!(wrong <= 40, "{wrap} {surface}: {wrong} pixels apart");
            let plain = crate::adapter::render(&plan("none", wrap, surface), Extras::default());
            assert_eq!(plain.depth, there.depth);
            let (moved, hits) = (apart(&plain, &there, 0.01), there.census()[0]);
            // Walls and what lies in shadow differ little.
            let most = 2 * moved > hits;
            assert!(most && hits > 1000, "{moved} of {hits} pixels colored");
        }
    }
}

#[test]
fn a_truth_depends_on_the_texels_of_a_file() {
    let folder = Folder::new();
    let contents = |size, texels: &[u8]| {
        folder.write("t.png", png(size, ColorType::Rgb, BitDepth::Eight, texels));
        let file = folder.0.join("t.png").display().to_string();
        let scene = plan(&file, "none", "bilinear").scene;
        scene.contents(&Assets::default())
    };
    let before = contents(SIZE, &texels());
    let mut other = texels();
    other[40] ^= 1;
    assert_ne!(contents(SIZE, &other), before);
    // Two rows of twelve are other than four of six.
    assert_ne!(contents([12, 2], &texels()), before);
}

#[test]
fn what_colors_nothing_is_refused_or_told() {
    let folder = Folder::new();
    written(&folder);
    folder.write("cut.png", &folder.bytes("t.png")[..60]);
    folder.write("t.txt", "colours");
    let clear = png([1, 1], ColorType::Rgba, BitDepth::Eight, &[9, 9, 9, 0]);
    folder.write("clear.png", clear);
    let terrain = "render terrain --device cpu --set scene.field=fbm:8x8 --size 24x16 -o a.png";
    let with = |texture: &str| format!("{terrain} --set scene.texture={texture}");
    for (texture, parts) in [
        ("there.png", "there.png|cannot be read"),
        ("cut.png", "cut.png|ends before its end"),
        ("t.txt", "t.txt|is no PNG|JPEG|WebP"),
        (".", "is a folder"),
        ("t.png --set scene.paint=exact", "scene.paint|height"),
    ] {
        folder.fails(&with(texture), 2, parts);
    }
    let told = said(&folder.done(&with("clear.png")));
    holds(&told, &["note: clear.png is transparent"]);
    // Depths need no colours.
    let explain = with("t.png") + " --explain";
    let shown = |command: &str| text(&folder.done(command));
    assert!(shown(&explain).contains("texture.wgsl"));
    assert!(!shown(&(explain + " --layer depth")).contains("texture.wgsl"));
}

#[test]
fn what_is_read_is_never_written_over() {
    let folder = Folder::new();
    written(&folder);
    let toml = "[scene]\nkind = \"heightfield\"\nfield = \"t.png\"\n[image]\nsize = [16, 9]\n";
    folder.write("p.toml", toml);
    let before = ["t.png", "p.toml"].map(|name| folder.bytes(name));
    let terrain = "render terrain --device cpu --size 24x16 --set scene.field=fbm:8x8";
    let colored = format!("{terrain} --set scene.texture=t.png");
    for line in [
        "COLORED -o t.png: the picture, scene.texture, -o",
        "COLORED -o ./t.png: the picture, scene.texture, -o",
        "COLORED -o b.png --stats t.png: --stats, scene.texture",
        "render p.toml --device cpu -o b.png --stats p.toml: --stats, the preset",
        "bench steps p.toml --device cpu --json t.png: --json, scene.field",
        "bench steps p.toml --device cpu --json p.toml: --json, a preset",
    ] {
        let (command, words) = line.split_once(": ").unwrap();
        let command = command.replace("COLORED", &colored);
        folder.fails(&command, 2, &words.replace(", ", "|"));
    }
    // A built-in preset is no file, whatever an output is called.
    let own = "render mandelbox --device cpu --size 8x8 -o b.png --stats mandelbox";
    folder.done(own);
    assert_eq!(["t.png", "p.toml"].map(|name| folder.bytes(name)), before);
}
