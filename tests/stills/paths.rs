//! Pictures whose light is followed from surface to surface.

use std::sync::Arc;

use conemarch::base::shader::Sources;
use conemarch::picture::frame::Frame;
use conemarch::plan::layers::Trap;
use conemarch::plan::look::{LightMode, Look};
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{BUILTIN, load};
use conemarch::scene::Assets;
use glam::DVec3;

use alone::alone;

use super::common::folder::Folder;
use super::common::plans::{preset, sized};
use super::sky::file;
use super::unhurried::replaced;
use super::work::{bits, bits_however_cut};
use crate::adapter::{self, EVERYTHING, HIT, both, on_cpu, render};

#[path = "../../benches/common/alone.rs"]
mod alone;

/// The plan with paths.
fn followed(mut plan: Plan, samples: u32) -> Plan {
    plan.look.mode = LightMode::Path;
    plan.samples = samples;
    plan
}

/// Mean light of all pixels whose centres hit, in each channel.
fn channels(frame: &Frame) -> DVec3 {
    let hits = frame.radiance.iter().zip(&frame.state);
    let hits = hits.filter(|(_, state)| **state == HIT);
    let all: Vec<DVec3> = hits.map(|(c, _)| c.map(f64::from).into()).collect();
    all.iter().sum::<DVec3>() / all.len() as f64
}

/// The mean of the three channels.
fn mean(frame: &Frame) -> f64 {
    channels(frame).element_sum() / 3.0
}

/// A white relief in white light from all sides.
fn white_relief(folder: &Folder) -> Plan {
    let white = folder.0.join("white.png");
    image::RgbImage::from_pixel(4, 4, [255; 3].into())
        .save(&white)
        .expect("a file");
    let texture = format!("scene.texture={}", white.display());
    // Normals that are not those of the surface lose light.
    let of_surface = "scene.normals=patches";
    let mut plan = preset("terrain", &["scene.field=fbm:64x64", of_surface, &texture]);
    plan.size = [32, 18];
    let look = &mut plan.look;
    (look.sky_low, look.sky_high, look.light_color) = (DVec3::ONE, DVec3::ONE, DVec3::ZERO);
    (look.fill, look.ground, look.fog) = (1.0, 1.0, 0.0);
    plan
}

/// Nothing but the border of the relief can be seen.
#[test]
fn a_white_relief_in_white_light_is_white() {
    let folder = Folder::new();
    for (roughness, metal, gloss) in [
        (0.45, 0.0, 0.0),
        (0.05, 1.0, 0.08),
        (0.3, 0.5, 0.5),
        (1.0, 0.0, 0.08),
    ] {
        let mut plan = white_relief(&folder);
        plan.look.bounces = 16;
        let look = &mut plan.look;
        (look.roughness, look.metal, look.gloss) = (roughness, metal, gloss);
        for frame in both(&followed(plan, 16)) {
            let light = mean(&frame);
            println!("{roughness} {metal} {gloss}: {light:.5}");
            assert!(
                (light - 1.0).abs() < 5e-3,
                "{roughness} {metal} {gloss}: {light}"
            );
        }
    }
}

/// Without bounces, only what is near stops the light of the sky, with and without a file.
#[test]
fn light_of_the_sky_is_stopped_within_the_reach() {
    let folder = Folder::new();
    let even = file(&folder, "even.hdr", [64, 32], |_, _| [1.0; 3]);
    for sky in ["none".to_string(), even.display().to_string()] {
        let [near, far] = [1e-4, 1.0].map(|reach| {
            let mut plan = white_relief(&folder);
            plan.look.sky.sky_file = sky.clone();
            (plan.look.bounces, plan.look.occlusion_reach) = (0, reach);
            both(&followed(plan, 64)).map(|frame| mean(&frame))
        });
        for (near, far) in near.into_iter().zip(far) {
            println!("{sky}: {near:.5} {far:.5}");
            // Hollows of a part of a pixel are left.
            assert!((near - 1.0).abs() < 0.01, "{sky}: {near}");
            assert!(far < 0.9, "{sky}: {far}");
        }
    }
}

/// Paths that end by chance stand for those that go on.
#[test]
fn paths_that_end_by_chance_lose_no_light() {
    const PATH: &str = include_str!("../../wgsl/pass/path.wgsl");
    let sure = |path: &str| {
        let is_it = path == "wgsl/pass/path.wgsl";
        is_it.then(|| replaced(PATH, "PATH_SURE = 2u;", "PATH_SURE = 99u;"))
    };
    let mut plan = followed(sized("mandelbox-gate", [32, 18]), 256);
    plan.look = Look {
        mode: LightMode::Path,
        bounces: 8,
        fill: 1.0,
        key: 0.0,
        // On surfaces as bright as this, 2 % of the light is lost if those that go on do not stand for the others.
        palette: vec![DVec3::splat(0.95); 2],
        ..Look::default()
    };
    let mut renderer = adapter::open();
    let [by_chance, all] = [None, Some(Arc::new(sure) as Sources)].map(|sources| {
        renderer.sources = sources;
        let frame = renderer.render(&plan, &Assets::default(), Extras::default(), &mut |_| true);
        mean(&frame.unwrap())
    });
    println!("{by_chance:.5} {all:.5}");
    assert_ne!(by_chance, all);
    assert!((by_chance / all - 1.0).abs() < 0.005, "{by_chance} {all}");
}

/// On a body without hollows, a dull surface under a small sun is as bright as the formula says.
#[test]
fn the_sun_shines_once() {
    let mut plan = sized("terrain", [48, 27]);
    plan.look.gloss = 0.0;
    plan.look.fill = 0.0;
    plan.look.light_size = 0.05;
    plan.look.bounces = 0;
    let [quick, path] = [LightMode::Quick, LightMode::Path].map(|mode| {
        let mut plan = followed(plan.clone(), 16);
        plan.look.mode = mode;
        mean(&render(&plan, Extras::default()))
    });
    println!("{quick} {path}");
    assert!((path / quick - 1.0).abs() < 5e-3, "{quick} {path}");
}

/// The variance of the mean of n independent samples is 1/n of that of one, and less where they are
/// spread evenly.
#[test]
fn noise_falls_with_the_samples() {
    for name in ["mandelbox", "mandelbox-gate", "terrain"] {
        let mut plan = sized(name, [32, 18]);
        plan.look = Look::default();
        // Many samples of the fine details are needed too: shade no finer ones than the pixel's.
        plan.reference = None;
        let fine = render(&followed(plan.clone(), 1024), Extras::default());
        assert!(mean(&fine) > 0.1, "{name}: {}", mean(&fine));
        let squares = |frame: &Frame| {
            let fine = fine.radiance.iter().flatten();
            let pairs = frame.radiance.iter().flatten().zip(fine);
            pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / (3.0 * 32.0 * 18.0)
        };
        let errors =
            [4, 16, 64].map(|n| squares(&render(&followed(plan.clone(), n), Extras::default())));
        println!("{name}: {errors:?}");
        let slope = (errors[2] / errors[0]).log(16.0);
        assert!(slope < -1.0, "{name}: {slope}");
    }
}

#[test]
fn both_executors_find_the_same_light() {
    // All that have this light, and some others. One gets a layer of colour.
    let own = |name: &&str| load(name, &[]).unwrap().plan.look.mode == LightMode::Path;
    let mut names: Vec<_> = BUILTIN.iter().map(|(name, _)| *name).filter(own).collect();
    assert!(names.contains(&"mandelbox-gold"));
    names.extend(["mandelbox", "mandelbox-hall", "terrain"]);
    for name in names {
        let mut plan = followed(sized(name, [48, 27]), 8);
        if name == "mandelbox-gold" {
            let layers = &mut plan.look.layers;
            layers.layer2_trap = Trap::Point;
            layers.layer2_palette = vec![DVec3::X, DVec3::Y];
        }
        let [gpu, cpu] = both(&plan);
        let pairs = gpu.radiance.iter().zip(&cpu.radiance);
        for weights in [[1.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let off = pairs
                .clone()
                .map(|(a, b)| (0..3).map(|c| weights[c] * f64::from(a[c] - b[c])).sum());
            let off: Vec<f64> = off.collect();
            let n = off.len() as f64;
            let mean = off.iter().sum::<f64>() / n;
            let spread = off.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
            let error = (spread / n).sqrt();
            println!("{name}: {mean:.2e} of {error:.2e}");
            // In f32 all pixels of a relief may be off to one side, by a part of their last bit.
            let rounding = 1e-7;
            assert!(
                mean.abs() <= 3.0 * error + rounding,
                "{name}: {mean} {error}"
            );
            // Most paths are the same on both.
            let same = off
                .iter()
                .filter(|x| x.abs() < 0.007 * weights.iter().sum::<f64>())
                .count() as f64;
            assert!(same > 0.7 * n, "{name}: {same} of {n}");
        }
    }
}

#[test]
fn paths_are_the_same_in_blocks_and_slices() {
    let plan = followed(sized("mandelbox-gate", [70, 44]), 3);
    bits_however_cut(&plan);
}

/// Who looks at the quick light while they work gets about the same picture: the views of all kinds of
/// light that docs/accuracy.md counts as alike.
#[test]
fn quick_light_is_about_as_bright_in_each_colour() {
    let views = [
        "mandelbox",
        "mandelbox-avenue",
        "mandelbox-canyon",
        "mandelbox-clay",
        "mandelbox-ember",
        "mandelbox-forge",
        "mandelbox-gold",
        "mandelbox-plain",
        "mandelbox-reef",
        "mandelbox-shell",
        "mandelbox-vault",
        "terrain",
        "stones",
        "valley-mist",
    ];
    for name in views {
        let mut plan = followed(sized(name, [48, 27]), 32);
        let path = channels(&render(&plan, Extras::default()));
        plan.look.mode = LightMode::Quick;
        let quick = channels(&on_cpu(&plan, Extras::default()));
        println!("{name}: {:.2}", path / quick);
        let ratios = (path / quick).to_array();
        assert!(
            ratios.iter().all(|ratio| (0.75..1.5).contains(ratio)),
            "{name}: {quick} {path}"
        );
    }
}

/// The rays of a surface share their first step. The picture is that of rays that do not.
#[test]
fn shared_first_steps_change_no_bit() {
    let mut differs = 0;
    for (name, steps) in [
        ("mandelbox", 512),
        ("mandelbox-gate", 5),
        ("mandelbox-stage", 512),
    ] {
        let mut plan = followed(sized(name, [64, 36]), 3);
        plan.look.bounces = 2;
        plan.look.shadow_steps = Some(steps);
        let mut renderer = adapter::open();
        renderer.sources = Some(Arc::new(alone));
        let plain = renderer.render(&plan, &Assets::default(), EVERYTHING, &mut |_| true);
        let shared = render(&plan, EVERYTHING);
        assert!(bits(&plain.unwrap()) == bits(&shared), "{name}");
        // Each step counts.
        plan.look.shadow_steps = Some(steps - 1);
        differs += usize::from(bits(&render(&plan, EVERYTHING)) != bits(&shared));
    }
    assert!(differs > 0);
}

/// Rays to the sun and to lamps go to the same points in both modes. In the folds of this view most rays to a
/// light pass near some surface.
#[test]
fn shadows_of_quick_light_are_those_of_paths() {
    for lamp in [0.0, 1.0] {
        let mut plan = followed(sized("mandelbox-temple", [96, 54]), 16);
        let look = &mut plan.look;
        // One light, on matte surfaces.
        (look.fill, look.fog, look.bounces, look.roughness) = (0.0, 0.0, 0, 1.0);
        (look.lamp, look.lamp_at) = (lamp, Some(plan.camera.eye + DVec3::splat(0.05)));
        look.key *= 1.0 - lamp;
        (look.light_size, look.lamp_size) = (4.0, 0.1);
        let path = render(&plan, Extras::default());
        plan.look.mode = LightMode::Quick;
        let vector = |c: &[f32; 3]| DVec3::from(c.map(f64::from));
        let light: f64 = path.radiance.iter().map(|c| vector(c).length()).sum();
        let off = |plan: &Plan| {
            let quick = render(plan, Extras::default());
            let pixels = quick.radiance.iter().zip(&path.radiance);
            let off = pixels.map(|(a, b)| (vector(a) - vector(b)).length());
            off.sum::<f64>() / light
        };
        let discs = off(&plan);
        (plan.look.light_size, plan.look.lamp_size) = (0.05, 1e-4);
        let middle = off(&plan);
        println!("lamp {lamp}: {discs:.4}, with rays to the middle {middle:.4}");
        assert!(
            discs < 0.06 && middle > 2.0 * discs,
            "{lamp}: {discs} {middle}"
        );
    }
}
