//! Pictures over reliefs: where their texels lie, on both executors, and what is refused.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

mod adapter;
#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod folder;
    pub mod pictures;
}

use common::folder::{Folder, said};
use common::pictures::png;
use conemarch::base::srgb::linear;
use conemarch::cpu;
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::settings::{HeightfieldSettings, Wrap};
use conemarch::heightfield::texture::Texture;
use conemarch::plan::camera::Camera;
use conemarch::plan::{Extras, Plan};
use conemarch::scene::Assets;
use conemarch::scene::Scene;
use glam::DVec3;
use png::{BitDepth, ColorType};

/// Six columns and four rows, no two texels alike.
const SIZE: [u32; 2] = [6, 4];

fn texels() -> Vec<u8> {
    (0..SIZE[0] * SIZE[1] * 3)
        .map(|i| (i * 79 % 251) as u8)
        .collect()
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

fn relief(size: [u32; 2], wrap: [bool; 2], patches: Patches, tiles: [u32; 2]) -> HeightSurface {
    let flat = vec![0.5; (size[0] * size[1]) as usize];
    HeightSurface::new(Heights::new(size, wrap, flat).unwrap(), patches, tiles).unwrap()
}

#[test]
fn a_texel_lies_on_each_sample_of_a_map_of_the_same_size() {
    let folder = Folder::new();
    let texture = written(&folder);
    let same = |relief: &HeightSurface, cell, uv, wanted: DVec3| {
        let own = texture.at(relief, cell, uv);
        assert!(
            (own - wanted).abs().max_element() < 1e-12,
            "{cell:?} {uv:?}: {own} {wanted}"
        );
    };
    // Patches have samples at their corners; tiles and borders come round.
    let tiled = relief(SIZE, [true, true], Patches::Bilinear, [2, 3]);
    for (x, y) in (0..4 * 3).flat_map(|y| (0..6 * 2).map(move |x| (x, y))) {
        let [i, j] = [x as u32 % 6, y as u32 % 4];
        same(&tiled, [x, y], [0.0, 0.0], texel(i, j));
        let next = texel((i + 1) % 6, (j + 1) % 4);
        same(&tiled, [x, y], [1.0, 1.0], next);
        let across = texel(i, j).lerp(texel((i + 1) % 6, j), 0.25);
        same(&tiled, [x, y], [0.25, 0.0], across);
    }
    // Without wrapping the last cell ends at the last sample.
    let ended = relief(SIZE, [false, false], Patches::Bilinear, [1, 1]);
    same(&ended, [4, 2], [1.0, 1.0], texel(5, 3));
    same(&ended, [0, 0], [0.0, 1.0], texel(0, 1));
    // A box is a sample, whose texel lies on its middle; its outer half keeps that colour.
    let boxes = relief(SIZE, [false, false], Patches::Boxes, [1, 1]);
    same(&boxes, [2, 3], [0.5, 0.5], texel(2, 3));
    same(&boxes, [5, 3], [0.9, 0.75], texel(5, 3));
    // The one cell of a single sample shows the whole picture, and so does one row of it.
    let single = relief([1, 1], [false, false], Patches::Bilinear, [1, 1]);
    same(&single, [0, 0], [1.5 / 6.0, 2.5 / 4.0], texel(1, 2));
    let row = relief([1, 4], [false, false], Patches::Bilinear, [1, 1]);
    same(&row, [0, 2], [5.5 / 6.0, 0.0], texel(5, 2));
    // Of another size it is stretched: each of these boxes is two texels by one.
    let wide = relief([3, 4], [false, false], Patches::Boxes, [1, 1]);
    same(&wide, [1, 2], [0.25, 0.5], texel(2, 2));
    same(&wide, [1, 2], [0.75, 0.5], texel(3, 2));
}

#[test]
fn grey_and_sixteen_bits_are_read() {
    let folder = Folder::new();
    let one = relief([1, 1], [false, false], Patches::Boxes, [1, 1]);
    let color = |color, depth, bytes: &[u8]| {
        folder.write("one.png", png([1, 1], color, depth, bytes));
        let texture = Texture::read(&folder.0.join("one.png")).unwrap();
        (texture.at(&one, [0, 0], [0.5, 0.5]), texture.note())
    };
    let is = |own: DVec3, r: f64, g: f64, b: f64| {
        own.abs_diff_eq(linear(DVec3::new(r, g, b) / 255.0), 1e-12)
    };
    let (grey, note) = color(ColorType::Grayscale, BitDepth::Eight, &[100]);
    assert!(is(grey, 100.0, 100.0, 100.0) && note.is_none());
    let (grey, note) = color(ColorType::GrayscaleAlpha, BitDepth::Eight, &[100, 7]);
    assert!(is(grey, 100.0, 100.0, 100.0) && note.unwrap().contains("alpha"));
    // 0x6400 of 65535 is 99.6 of 255.
    let wide = [0x64, 0x00, 0xff, 0xff, 0, 0];
    let (rgb, note) = color(ColorType::Rgb, BitDepth::Sixteen, &wide);
    assert!(is(rgb, 100.0, 255.0, 0.0) && note.is_none());
    let (rgb, note) = color(ColorType::Rgba, BitDepth::Eight, &[1, 2, 3, 255]);
    assert!(
        is(rgb, 1.0, 2.0, 3.0) && note.is_none(),
        "alpha that hides nothing"
    );
}

/// A plan of a small map of noise under the texture.
fn plan(folder: &Folder, wrap: Wrap, patches: Patches) -> Plan {
    let mut shape = HeightfieldSettings::default();
    shape.source.field = "noise:7x5,seed=3".into();
    shape.source.wrap = wrap;
    shape.patches = patches;
    if wrap == Wrap::Both {
        shape.tiles = [2, 1];
    }
    shape.texture = folder.0.join("t.png").to_string_lossy().into_owned();
    let mut plan = Plan::new(Scene::Heightfield(shape));
    plan.size = [120, 80];
    plan.camera = Camera {
        eye: DVec3::new(3.0, -9.0, 9.0),
        target: DVec3::ZERO,
        up: DVec3::Z,
        ..plan.camera
    };
    plan
}

#[test]
fn both_executors_color_alike_and_by_the_texture() {
    let folder = Folder::new();
    written(&folder);
    for wrap in [Wrap::None, Wrap::Both] {
        for patches in [Patches::Bilinear, Patches::Boxes] {
            let plan = plan(&folder, wrap, patches);
            let here =
                cpu::render(&plan, &Assets::default(), Extras::default(), &mut |_| true).unwrap();
            let there = adapter::render(&plan, Extras::default());
            let apart = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 0.01);
            let pairs = here.radiance.iter().zip(&there.radiance);
            let wrong = pairs.filter(|(a, b)| apart((a, b))).count();
            assert!(wrong <= 40, "{wrap:?} {patches:?}: {wrong} pixels apart");
            let mut other = plan.clone();
            let Scene::Heightfield(shape) = &mut other.scene else {
                unreachable!("made above");
            };
            shape.texture = "none".into();
            let plain = adapter::render(&other, Extras::default());
            assert_eq!(plain.depth, there.depth);
            let pairs = plain.radiance.iter().zip(&there.radiance);
            let moved = pairs.filter(|(a, b)| apart((a, b))).count();
            let hits = there.census()[0];
            // Walls and what lies in shadow differ little.
            let most = 2 * moved > hits;
            assert!(most && hits > 1000, "{moved} of {hits} pixels colored");
        }
    }
}

#[test]
fn a_truth_depends_on_the_texels_of_a_file() {
    let folder = Folder::new();
    written(&folder);
    let before = plan(&folder, Wrap::None, Patches::Bilinear)
        .scene
        .contents(&Assets::default());
    let mut bytes = texels();
    bytes[40] ^= 1;
    folder.write("t.png", png(SIZE, ColorType::Rgb, BitDepth::Eight, &bytes));
    assert_ne!(
        plan(&folder, Wrap::None, Patches::Bilinear)
            .scene
            .contents(&Assets::default()),
        before
    );
    // Two rows of twelve are other than four of six.
    let turned = png([12, 2], ColorType::Rgb, BitDepth::Eight, &texels());
    folder.write("t.png", turned);
    assert_ne!(
        plan(&folder, Wrap::None, Patches::Bilinear)
            .scene
            .contents(&Assets::default()),
        before
    );
}

#[test]
fn what_colors_nothing_is_refused_or_told() {
    let folder = Folder::new();
    written(&folder);
    folder.write("cut.png", &folder.bytes("t.png")[..60]);
    folder.write("t.txt", "colours");
    folder.write(
        "clear.png",
        png([1, 1], ColorType::Rgba, BitDepth::Eight, &[9, 9, 9, 0]),
    );
    let render = |set: &'static str| {
        let small = ["--set", "scene.field=fbm:8x8", "--size", "24x16"];
        let args = [
            "render", "terrain", "--device", "cpu", "--set", set, "-o", "a.png",
        ];
        [&args[..], &small].concat()
    };
    for (set, words) in [
        (
            "scene.texture=there.png",
            &["there.png", "cannot be read"][..],
        ),
        ("scene.texture=cut.png", &["cut.png", "ends before its end"]),
        ("scene.texture=t.txt", &["t.txt", "is no PNG"]),
        ("scene.texture=.", &["is a folder"]),
    ] {
        folder.fails(&render(set), 2, words);
    }
    let both = [
        &render("scene.texture=t.png")[..],
        &["--set", "scene.paint=exact"],
    ]
    .concat();
    folder.fails(&both, 2, &["scene.paint", "height"]);
    let told = said(&folder.done(&render("scene.texture=clear.png")));
    assert!(told.contains("note: clear.png is transparent"), "{told}");
    // What is read is never written over, by whatever name.
    let over = |name: &'static str| {
        let small = ["--set", "scene.field=fbm:8x8", "--size", "24x16"];
        let set = ["--set", "scene.texture=t.png", "-o", name];
        [&["render", "terrain", "--device", "cpu"][..], &set, &small].concat()
    };
    let before = folder.bytes("t.png");
    for name in ["t.png", "./t.png"] {
        folder.fails(&over(name), 2, &["the picture", "scene.texture", "-o"]);
    }
    let stats = [&over("b.png")[..], &["--stats", "t.png"]].concat();
    folder.fails(&stats, 2, &["--stats", "scene.texture"]);
    let text = "[scene]\nkind = \"heightfield\"\nfield = \"t.png\"\n[image]\nsize = [16, 9]\n";
    folder.write("p.toml", text);
    let own = [
        "render", "p.toml", "--device", "cpu", "-o", "b.png", "--stats", "p.toml",
    ];
    folder.fails(&own, 2, &["--stats", "the preset"]);
    for (file, what) in [("t.png", "scene.field"), ("p.toml", "a preset")] {
        let bench = [
            "bench", "steps", "p.toml", "--device", "cpu", "--json", file,
        ];
        folder.fails(&bench, 2, &["--json", what]);
    }
    assert_eq!(folder.bytes("p.toml"), text.as_bytes());
    // A built-in preset is no file, whatever an output is called.
    let own = ["render", "mandelbox", "--device", "cpu", "--size", "8x8"];
    folder.done(&[&own[..], &["-o", "b.png", "--stats", "mandelbox"]].concat());
    assert_eq!(folder.bytes("t.png"), before);
    // Depths need no colours.
    let explain = [&render("scene.texture=t.png")[..], &["--explain"]].concat();
    let shown = |args: &[&str]| String::from_utf8(folder.done(args).stdout).unwrap();
    assert!(shown(&explain).contains("texture.wgsl"));
    let depths = [&explain[..], &["--layer", "depth"]].concat();
    assert!(!shown(&depths).contains("texture.wgsl"));
}
