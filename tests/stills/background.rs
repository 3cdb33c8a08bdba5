//! Pictures without a sky: the share of hits, and the light of the hits alone.

use conemarch::picture::frame::Frame;
use conemarch::picture::{BitDepth, Layer, Shades};
use conemarch::plan::look::LightMode;
use conemarch::plan::{Background, Extras, Plan, UNTIL_LEAST};
use glam::DVec3;

use super::common::plans::preset;
use super::until::tiles;
use super::work::bits;
use crate::adapter::{EVERYTHING, SKY, on_cpu, render};

/// A sky of one colour, in sRGB. Black light leaves no glow in it.
const EVEN: [&str; 4] = [
    "look.sky_high=[0.5, 0.6, 0.8]",
    "look.sky_low=[0.5, 0.6, 0.8]",
    "look.light_color=[0, 0, 0]",
    "image.size=[150, 139]",
];

fn even(name: &str, samples: u32) -> Plan {
    let mut plan = preset(name, &EVEN);
    plan.look.fog = 0.0;
    plan.samples = samples;
    plan
}

fn transparent(plan: &Plan) -> Plan {
    let mut plan = plan.clone();
    plan.background = Background::Transparent;
    plan
}

/// A box above sky, in one sample and in many, through a lens, by paths; and a heightfield.
fn plans() -> [Plan; 5] {
    let (mut lens, mut paths) = (even("mandelbox", 5), even("mandelbox", 3));
    lens.camera.aperture = 0.02;
    (paths.look.mode, paths.look.bounces) = (LightMode::Path, 1);
    let [one, many] = [1, 16].map(|samples| even("mandelbox", samples));
    [one, many, lens, paths, even("terrain", 4)]
}

#[test]
fn over_its_sky_a_transparent_picture_is_the_picture() {
    let sky = conemarch::base::srgb::linear(DVec3::new(0.5, 0.6, 0.8)).to_array();
    for plan in plans() {
        let clear = transparent(&plan);
        let mut alphas = Vec::new();
        for executor in [render, on_cpu] {
            let (sight, frame) = (executor(&plan, EVERYTHING), executor(&clear, EVERYTHING));
            assert!(sight.alpha.is_empty() && frame.alpha.len() == frame.state.len());
            assert!(frame.depth == sight.depth && frame.state == sight.state);
            assert!(frame.normal == sight.normal && frame.undecided == sight.undecided);
            let (mut edges, mut empty) = (0, 0);
            for (i, alpha) in frame.alpha.iter().enumerate() {
                let hits = alpha * plan.samples as f32;
                assert!((hits - hits.round()).abs() < 1e-5 && (0.0..=1.0).contains(alpha));
                if plan.samples == 1 {
                    assert_eq!(*alpha, f32::from(u8::from(frame.state[i] != SKY)));
                }
                for (c, sky) in sky.iter().enumerate() {
                    let over = f64::from(frame.radiance[i][c]) + f64::from(1.0 - alpha) * sky;
                    let off = (over - f64::from(sight.radiance[i][c])).abs();
                    assert!(off < 1e-5 * over.max(1.0), "{}: {i}: {off}", plan.title);
                }
                if *alpha == 0.0 {
                    assert_eq!(frame.radiance[i], [0.0; 3]);
                }
                edges += usize::from(*alpha > 0.0 && *alpha < 1.0);
                empty += usize::from(*alpha == 0.0);
            }
            assert!(
                empty > 100 && (edges > 100) == (plan.samples > 1),
                "{edges}"
            );
            alphas.push(frame.alpha);
        }
        // Few rays are so near to an edge that f32 decides.
        let pairs = alphas[0].iter().zip(&alphas[1]);
        let off: f32 = pairs.map(|(a, b)| (a - b).abs()).sum();
        let off = off / alphas[0].len() as f32;
        println!("{}, {} samples: {off}", plan.title, plan.samples);
        assert!(off < 2e-3, "{}: {off}", plan.title);
    }
}

/// What is shown of black hits is black, so only alpha tells that their edges are not done.
#[test]
fn tiles_do_not_end_before_their_alpha() {
    let mut plan = transparent(&preset("mandelbox", &["image.size=[150, 139]"]));
    (plan.samples, plan.until, plan.look.exposure) = (32, 0.01, -20.0);
    let [gpu, cpu] = [render, on_cpu].map(|executor| executor(&plan, EVERYTHING));
    let counts = tiles(&gpu);
    assert_eq!(counts, tiles(&cpu));
    for (i, count) in gpu.samples.iter().enumerate() {
        let hits = gpu.alpha[i] * *count as f32;
        assert!((hits - hits.round()).abs() < 1e-4 && gpu.alpha[i] <= 1.0);
    }
    let on = counts.iter().filter(|n| **n > UNTIL_LEAST).count();
    assert!(on > 0 && on < counts.len(), "{counts:?}");
}

/// What a window shows has the sky, and so has every layer but those of light.
#[test]
fn what_is_shown_and_other_layers_have_no_alpha() {
    let plan = even("mandelbox", 2);
    let clear = transparent(&plan);
    let shown = Extras {
        shown: true,
        ..EVERYTHING
    };
    assert!(bits(&render(&clear, shown)) == bits(&render(&plan, shown)));
    let [sight, frame] = [&plan, &clear].map(|plan| on_cpu(plan, EVERYTHING));
    let rows = |frame: &Frame, layer| Shades::new(layer, frame, &clear).rows(BitDepth::Eight);
    for layer in Layer::ALL {
        let same = rows(&frame, layer) == rows(&sight, layer);
        let of_light = matches!(layer, Layer::Color | Layer::Variance);
        assert_eq!(same, !of_light, "{layer:?}");
    }
}
