//! Tiles that end before they have all samples.

use conemarch::gpu::render::Cutting;
use conemarch::picture::frame::Frame;
use conemarch::picture::{Layer, Shades};
use conemarch::plan::pyramid::Block;
use conemarch::plan::{Extras, Plan, UNTIL_LEAST, UNTIL_TILE};
use conemarch::scene::Assets;

use super::common::plans::preset;
use super::work::bits;
use crate::adapter::{self, EVERYTHING, finish, on_cpu, render, render_cut};

/// Sky above, relief below, and tiles that are cut by the edges.
fn plan(until: f64) -> Plan {
    let mut plan = preset("mandelbox", &["image.size=[150, 139]"]);
    (plan.samples, plan.until) = (32, until);
    plan
}

/// Samples of each tile. All its pixels have as many.
pub fn tiles(frame: &Frame) -> Vec<u32> {
    let [width, height] = frame.size;
    let step = UNTIL_TILE as usize;
    let mut all = Vec::new();
    for y in (0..height).step_by(step) {
        for x in (0..width).step_by(step) {
            let at = |x: u32, y: u32| frame.samples[(y * width + x) as usize];
            let (w, h) = (width.min(x + UNTIL_TILE), height.min(y + UNTIL_TILE));
            let same = (y..h).all(|v| (x..w).all(|u| at(u, v) == at(x, y)));
            assert!(same, "{x}, {y}");
            all.push(at(x, y));
        }
    }
    all
}

#[test]
fn tiles_end_alone_on_both_executors_and_however_the_work_is_cut() {
    let plan = plan(0.012);
    let (gpu, cpu) = (render(&plan, EVERYTHING), on_cpu(&plan, EVERYTHING));
    let counts = tiles(&gpu);
    println!("{counts:?}");
    assert_eq!(counts, tiles(&cpu));
    let ended: Vec<&u32> = counts.iter().filter(|n| **n < plan.samples).collect();
    assert!(!ended.is_empty() && ended.len() < counts.len());
    assert!(
        ended
            .iter()
            .all(|n| n.is_power_of_two() && **n >= UNTIL_LEAST)
    );
    for block in [64, 100, 128] {
        let cutting = Cutting {
            block,
            ..Cutting::default()
        };
        let cut = render_cut(&plan, EVERYTHING, cutting);
        assert!(
            bits(&cut) == bits(&gpu) && cut.samples == gpu.samples,
            "{block}"
        );
    }
    // A window has the tiles of the whole image.
    let mut part = plan.clone();
    part.window = Some(Block {
        origin: [64, 64],
        size: [86, 75],
    });
    for (part, whole) in [
        (render(&part, EVERYTHING), &gpu),
        (on_cpu(&part, EVERYTHING), &cpu),
    ] {
        for (i, light) in part.radiance.iter().enumerate() {
            let at = (64 + i / 86) * 150 + 64 + i % 86;
            assert!(*light == whole.radiance[at] && part.samples[i] == whole.samples[at]);
        }
    }
    // Depths, normals and states are those of the centres.
    let all = render(&self::plan(0.0), EVERYTHING);
    assert!(all.depth == gpu.depth && all.state == gpu.state && all.normal == gpu.normal);
    assert!(all.samples.is_empty());
}

#[test]
fn no_error_is_small_enough_for_a_tiny_bound() {
    for aperture in [0.0, 0.02] {
        let [mut tiny, mut all] = [plan(1e-9), plan(0.0)];
        for plan in [&mut tiny, &mut all] {
            (plan.samples, plan.camera.aperture) = (16, aperture);
        }
        for render in [render, on_cpu] {
            let (tiny, all) = (render(&tiny, EVERYTHING), render(&all, EVERYTHING));
            assert!(bits(&tiny) == bits(&all));
            assert!(tiny.samples == vec![16; 150 * 139]);
        }
    }
}

#[test]
fn sky_takes_fewer_samples_and_the_error_is_about_the_bound() {
    let mut truth = plan(0.0);
    truth.samples = 512;
    let truth = render(&truth, EVERYTHING);
    for until in [0.01, 0.03] {
        let mut plan = plan(until);
        plan.samples = 128;
        let frame = render(&plan, EVERYTHING);
        let [a, b] =
            [(&frame, &plan), (&truth, &plan)].map(|(f, p)| Shades::new(Layer::Color, f, p));
        let (mut off, mut count) = (0.0, 0.0);
        let (mut sky, mut relief) = ((0, 0), (0, 0));
        for (i, n) in frame.samples.iter().enumerate() {
            let to = if frame.state[i] == 0 {
                &mut sky
            } else {
                &mut relief
            };
            *to = (to.0 + n, to.1 + 1);
            if *n < plan.samples {
                off += (a.at(i) - b.at(i)).length_squared();
                count += 3.0;
            }
        }
        let mean = |(sum, n): (u32, u32)| f64::from(sum) / f64::from(n.max(1));
        let error = (off / f64::max(count, 1.0)).sqrt();
        println!(
            "{until}: {error:.4}, sky {:.1}, relief {:.1}",
            mean(sky),
            mean(relief)
        );
        assert!(count > 0.0 && error < 1.5 * until, "{until}: {error}");
        assert!(mean(sky) < mean(relief), "{sky:?} {relief:?}");
    }
}

/// The window refines to the bytes of the file, and a later plan starts with no tile ended.
#[test]
fn what_is_shown_are_the_bytes_of_the_file() {
    let (mut renderer, assets) = (adapter::open(), Assets::default());
    let extras = Extras {
        reuse: true,
        shown: true,
        ..Extras::default()
    };
    for until in [0.03, 1e-9, 0.03] {
        let plan = plan(until);
        let mut work = renderer.begin(&plan, &assets, extras).unwrap();
        let frame = finish(&mut work);
        let has_ended = tiles(&frame).iter().any(|n| *n < plan.samples);
        assert_eq!(has_ended, until > 1e-3);
        let file = Shades::new(Layer::Color, &frame, &plan).bytes();
        let shown = work.pixels().unwrap();
        let shown = shown.chunks(4).flat_map(|rgba| &rgba[..3]);
        assert!(shown.eq(&file), "{until}");
    }
}
