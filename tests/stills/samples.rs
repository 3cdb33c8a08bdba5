//! Pictures of many samples.

use conemarch::base::srgb::srgb;
#[cfg(feature = "preview")]
use conemarch::gpu::wait::read_picture;
use conemarch::pass::look::tone;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Plan};
#[cfg(feature = "preview")]
use conemarch::preview::pictures::Pictures;
use glam::DVec3;

use super::common::filtered::apart;
use super::common::plans::{preset, sized};
use super::work::{bits, bytes};
use crate::adapter::{self, EVERYTHING, on_cpu, render};

#[test]
fn samples_come_near_to_the_filtered_picture() {
    // Edges, shadows and a sky, whose places do not depend on the size of a pixel.
    let mut plan = preset("bricks", &["image.size=[48, 27]", "look.exposure=0"]);
    let mut fine = plan.clone();
    fine.size = plan.size.map(|n| n * 16);
    let fine = render(&fine, Extras::default());
    let mut errors = Vec::new();
    for samples in [1, 4, 16, 64, 256] {
        plan.samples = samples;
        let [bias, size] = apart(&render(&plan, Extras::default()), &fine, |light| light);
        println!("{samples}: bias {bias:.5}, size {size:.5}");
        errors.push(size);
        assert!(bias.abs() < 0.5 * size + 1e-3, "{samples}: {bias} {size}");
    }
    // Four times the samples leave at most 0.7 of the error; at random it would be 0.5.
    for two in errors.windows(2) {
        assert!(two[1] < 0.7 * two[0], "{errors:?}");
    }
}

#[test]
fn a_small_picture_is_the_large_one_made_small() {
    for name in ["mandelbox", "mandelbox-reef", "terrain"] {
        let mut large = sized(name, [320, 180]);
        large.samples = 4;
        let shown = |light: [f64; 3]| {
            let exposure = large.look.exposure.exp2();
            srgb(tone(exposure, DVec3::from(light))).to_array()
        };
        let fine = render(&large, Extras::default());
        let off = |reference: Option<u32>| {
            let mut small = sized(name, [80, 45]);
            (small.samples, small.reference) = (64, reference);
            255.0 * apart(&render(&small, Extras::default()), &fine, shown)[1]
        };
        let [with, without] = [Some(180), None].map(off);
        println!("{name}: {with:.2} of 255, {without:.2} without");
        assert!(with < 2.0, "{name}: {with}");
        assert!(name == "terrain" || without > 4.0, "{name}: {without}");
    }
}

/// A picture that is taller than the reference has the details of its own pixels.
#[test]
fn a_reference_counts_only_if_it_is_taller() {
    for executor in [render, on_cpu] {
        let with = |reference: Option<u32>| {
            let plan = Plan {
                reference,
                ..sized("mandelbox", [64, 48])
            };
            bits(&executor(&plan, EVERYTHING))
        };
        let own = with(None);
        assert!(with(Some(47)) == own && with(Some(49)) != own);
    }
}

/// The plan with other samples, with and without cones, and the same shell.
fn sampled(plan: &Plan, samples: u32, coarsest: u32) -> Plan {
    let mut plan = plan.clone();
    plan.samples = samples;
    plan.march.coarsest = Some(coarsest);
    plan.march.shell = Some(0.2);
    plan
}

#[test]
fn cones_serve_all_samples() {
    // On a fractal, shades follow the last digits of a hit; their share is that of one sample.
    for (name, most) in [("mandelbox", 0.11), ("terrain", 1e-3), ("stones", 1e-3)] {
        let plan = sized(name, [128, 72]);
        for (samples, aperture) in [(1, 0.0), (5, 0.0), (5, 0.02), (5, 0.25)] {
            let [cones, rays] = [32, 1].map(|coarsest| {
                let mut plan = sampled(&plan, samples, coarsest);
                plan.camera.aperture = aperture;
                render(&plan, Extras::default())
            });
            let pairs = cones.radiance.iter().zip(&rays.radiance);
            let differ = |(a, b): &(&[f32; 3], &[f32; 3])| {
                let off = |c: usize| (a[c] - b[c]).abs() > 0.02;
                (0..3).any(off)
            };
            let off = pairs.filter(differ).count() as f64 / cones.radiance.len() as f64;
            println!("{name}, {samples}, {aperture}: {off:.5} of the pixels differ");
            assert!(off < most, "{name}, {samples}, {aperture}: {off}");
        }
    }
}

#[test]
fn depth_normal_and_state_are_those_of_the_centre() {
    for name in ["mandelbox", "stones"] {
        let plan = sampled(&sized(name, [64, 36]), 1, 1);
        let one = render(&plan, EVERYTHING);
        for (samples, aperture) in [(2, 0.0), (5, 0.0), (5, 0.1)] {
            let mut many = sampled(&plan, samples, 1);
            many.camera.aperture = aperture;
            let many = render(&many, EVERYTHING);
            assert!(one.state == many.state);
            // The program of a lens may be rounded in other places.
            let rounding = if aperture > 0.0 { 3e-7 } else { 0.0 };
            let depths = one.depth.iter().zip(&many.depth);
            let is_same = |(a, b): (&f32, &f32)| a == b || (a - b).abs() <= rounding * a;
            assert!(
                depths.into_iter().all(is_same),
                "{name}, {samples}, {aperture}"
            );
            assert!(one.radiance != many.radiance);
            // The step of a difference follows the farthest point, which a lens moves away by its
            // radius.
            let pairs = one
                .normal
                .iter()
                .flatten()
                .zip(many.normal.iter().flatten());
            let off = pairs.filter(|(a, b)| (*a - *b).abs() > 0.01).count();
            let most = if aperture > 0.0 {
                one.normal.len() / 100
            } else {
                0
            };
            assert!(off <= most, "{name}, {samples}, {aperture}: {off}");
            let sum = |frame: &Frame| frame.work_per_pixel().unwrap().0;
            let factor = sum(&many) / sum(&one) / f64::from(samples);
            // Behind a lens, the centre has a ray more.
            assert!((0.8..1.3).contains(&factor), "{factor}");
        }
    }
}

#[test]
fn both_executors_take_the_same_samples() {
    for (name, coarsest, blades) in [
        ("mandelbox", 1, Some(5)),
        ("mandelbox", 16, None),
        ("terrain", 8, None),
        ("terrain", 1, Some(3)),
    ] {
        let mut plan = sampled(&sized(name, [64, 36]), 6, coarsest);
        plan.camera.blades = blades;
        plan.camera.aperture = 0.05;
        let (gpu, cpu) = (render(&plan, EVERYTHING), on_cpu(&plan, EVERYTHING));
        let pairs = gpu
            .radiance
            .iter()
            .flatten()
            .zip(cpu.radiance.iter().flatten());
        let mut off: Vec<f32> = pairs.map(|(a, b)| (a - b).abs()).collect();
        off.sort_by(f32::total_cmp);
        let [middle, most] = [off.len() / 2, off.len() * 95 / 100].map(|i| off[i]);
        println!("{name}, {coarsest}: {middle:.2e} {most:.2e}");
        assert!(middle < 2e-5 && most < 2e-2, "{name}: {middle} {most}");
        assert_eq!(gpu.undecided, cpu.undecided, "{name}");
    }
}

#[test]
fn depths_alone_take_one_sample() {
    let plan = sampled(&sized("mandelbox", [64, 36]), 9, 8);
    let depths = Extras {
        depth_only: true,
        ..EVERYTHING
    };
    let one = sampled(&plan, 1, 8);
    assert!(bits(&render(&plan, depths)) == bits(&render(&one, depths)));
}

/// A window of several blocks shows each one that has all its samples, while the others have one.
#[cfg(feature = "preview")]
#[test]
fn a_large_window_is_refined_block_by_block() {
    let mut pictures = Pictures::new(adapter::open().device);
    pictures.renderer.cutting.block = 32;
    let unread = Extras {
        unread: true,
        ..Extras::default()
    };
    pictures.keep(unread, true);
    for size in [[96, 80], [80, 96]] {
        let mut plan = sized("mandelbox", size);
        let one = bytes(&plan, &render(&plan, Extras::default()));
        plan.samples = 40;
        let all = bytes(&plan, &render(&plan, Extras::default()));
        pictures.want(&plan);
        let mut seen = Vec::new();
        while pictures.is_busy() {
            if pictures.advance().unwrap() && pictures.is_full() {
                let shown = pictures.finished().unwrap().texture.unwrap();
                seen.push(read_picture(&pictures.renderer.device, shown).unwrap());
            }
        }
        assert!(seen[0] == one && *seen.last().unwrap() == all);
        // The first row of blocks, and the rest.
        let row = 4 * 32 * size[0] as usize;
        let half = seen
            .iter()
            .any(|shown| shown[..row] == all[..row] && shown[2 * row..] == one[2 * row..]);
        assert!(half, "{} pictures", seen.len());
        // What is finished stays. A mixture of samples does not count as full.
        pictures.rest();
        assert!(pictures.is_full());
        plan.samples = 41;
        pictures.want(&plan);
        let mut shown = 0;
        while shown < 2 {
            assert!(pictures.is_busy());
            shown += u32::from(pictures.advance().unwrap() && pictures.is_full());
        }
        pictures.rest();
        assert!(!pictures.is_full());
    }
}
