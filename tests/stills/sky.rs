//! Light of a sky in a file.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use conemarch::base::projection::Projection;
use conemarch::picture::frame::Frame;
use conemarch::plan::Plan;
use conemarch::plan::look::LightMode;
use glam::DVec3;

use super::common::folder::Folder;
use super::common::plans::{scene, sized};
use super::work::bits_however_cut;
use crate::adapter::{HIT, both};

/// A Radiance HDR of light by column and row.
pub fn file(
    folder: &Folder,
    name: &str,
    [w, h]: [u32; 2],
    light: impl Fn(u32, u32) -> [f32; 3],
) -> PathBuf {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {h} +X {w}\n").into_bytes();
    for i in 0..w * h {
        let c = light(i % w, i / w);
        let exponent = c.into_iter().fold(1e-9, f32::max).log2().floor() as i32 + 1;
        bytes.extend(c.map(|x| (x * 256.0 / 2f32.powi(exponent)) as u8));
        bytes.push((exponent + 128) as u8);
    }
    let path = folder.0.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// The plan under the sky of a file, and no other light.
fn under(mut plan: Plan, path: &Path) -> Plan {
    plan.look.sky.sky_file = path.display().to_string();
    (plan.look.key, plan.look.fill, plan.look.fog) = (0.0, 1.0, 0.0);
    plan
}

/// A disc seen from above. It fills the picture if it is large.
fn disc(radius: u32) -> Plan {
    let slab = format!("kind = 'slab'\nnormal = [0, 0, 1]\nhalf = 0.3\nradius = {radius}");
    let mut plan = Plan::new(scene(&slab));
    plan.samples = 1;
    (plan.camera.eye, plan.camera.target) = (DVec3::new(0.5, -6.0, 4.0), DVec3::ZERO);
    plan.size = [48, 27];
    let look = &mut plan.look;
    (look.mode, look.bounces, look.gloss) = (LightMode::Path, 0, 0.0);
    plan
}

/// Mean green light of the pixels that hit the top.
fn mean(frame: &Frame) -> f64 {
    let all = frame.radiance.iter().zip(&frame.state).zip(&frame.normal);
    let top = all.filter(|((_, state), normal)| **state == HIT && normal[2] > 0.9);
    let lit: Vec<f64> = top.map(|((c, _), _)| f64::from(c[1])).collect();
    assert!(lit.len() > 100);
    lit.iter().sum::<f64>() / lit.len() as f64
}

/// A panorama as large as the file has the file's numbers: its middle is toward +y, and to the left of
/// it after a turn.
#[test]
fn a_panorama_of_nothing_is_the_file() {
    let folder = Folder::new();
    let exact = |x: u32, y: u32| [(4 + x) as f32 / 64.0, (1 + y) as f32 / 32.0, 1.0];
    let path = file(&folder, "sky.hdr", [32, 16], exact);
    for (turn, shift) in [(0.0, 0), (90.0, 8)] {
        let mut plan = under(disc(4), &path);
        (plan.camera.eye, plan.camera.target) = (DVec3::new(0.0, -6.0, 0.0), DVec3::ZERO);
        (plan.camera.projection, plan.camera.fov) = (Projection::Equirectangular, 180.0);
        (plan.size, plan.look.sky.sky_turn) = ([32, 16], turn);
        (plan.look.mode, plan.look.sky.sky_strength) = (LightMode::Quick, 2.0);
        for frame in both(&plan) {
            let mut seen = 0;
            for (i, c) in (0..).zip(&frame.radiance) {
                if frame.depth[i as usize].is_infinite() {
                    let wanted = exact((i % 32 + shift) % 32, i / 32).map(|x| 2.0 * x);
                    let off = (0..3).map(|k| (c[k] - wanted[k]).abs()).fold(0.0, f32::max);
                    assert!(off < 2e-4, "{turn}: {i} {c:?} {wanted:?}");
                    seen += 1;
                }
            }
            assert!(seen > 300, "{seen}");
        }
    }
}

/// A wall gets what the half space before it sends, a small sun included.
#[test]
fn a_wall_gets_the_light_of_its_half_space() {
    let folder = Folder::new();
    let even = file(&folder, "even.hdr", [64, 32], |_, _| [1.0; 3]);
    let sunny = |x: u32, y: u32| match (x, y) {
        (40, 9) => [4096.0; 3],
        _ => [0.25 + y as f32 / 64.0; 3],
    };
    let sun = file(&folder, "sun.hdr", [64, 32], sunny);
    let mut exact = 0.0;
    for y in 0..16 {
        let down = |y: u32| PI * f64::from(y) / 32.0;
        // The integral of sin cos over the row, and over one column.
        let share = (down(y + 1).sin().powi(2) - down(y).sin().powi(2)) / 2.0 * (2.0 * PI / 64.0);
        exact += (0..64)
            .map(|x| f64::from(sunny(x, y)[1]) * share / PI)
            .sum::<f64>();
    }
    for (roughness, samples) in [(1.0, 64), (0.2, 64)] {
        let lit = |path: &Path| {
            let mut plan = under(disc(40), path);
            (plan.samples, plan.look.roughness) = (samples, roughness);
            both(&plan).map(|frame| mean(&frame))
        };
        let [even, sun] = [lit(&even), lit(&sun)];
        for (even, sun) in even.into_iter().zip(sun) {
            println!("{roughness}: {} {exact}", sun / even);
            // The bilinear sun is a little wider than its texel.
            assert!(
                (sun / even / exact - 1.0).abs() < 0.01,
                "{} {exact}",
                sun / even
            );
        }
    }
}

/// Mirrors and walls under an even sky are as bright as it is: no direction is counted twice.
#[test]
fn the_weights_of_both_rays_sum_to_one() {
    let folder = Folder::new();
    // One channel is even, and another one decides where rays are sent.
    let light = |x: u32, y: u32| [if (x, y) == (10, 6) { 3000.0 } else { 0.5 }, 0.5, 0.5];
    let path = file(&folder, "sky.hdr", [64, 32], light);
    // So bright a texel has little precision in its other channels.
    let path_even = file(&folder, "even.hdr", [64, 32], |_, _| [0.5; 3]);
    for (roughness, metal, gloss) in [(0.1, 1.0, 0.08), (0.5, 0.0, 2.0)] {
        let [chosen, even] = [&path, &path_even].map(|path| {
            let mut plan = under(disc(40), path);
            plan.look.palette = vec![DVec3::ONE];
            (plan.samples, plan.look.roughness) = (256, roughness);
            (plan.look.metal, plan.look.gloss) = (metal, gloss);
            both(&plan).map(|frame| mean(&frame))
        });
        for (chosen, even) in chosen.into_iter().zip(even) {
            println!("{roughness} {metal} {gloss}: {chosen} {even}");
            assert!((chosen / even - 1.0).abs() < 0.01, "{chosen} {even}");
        }
    }
}

#[test]
fn quick_light_of_a_file_is_about_that_of_paths() {
    let folder = Folder::new();
    let path = file(&folder, "sky.hdr", [64, 32], |x, y| {
        [1.0, if x < 32 { 2.0 } else { 0.5 }, 0.1 * (32 - y) as f32]
    });
    let [quick, followed] = [LightMode::Quick, LightMode::Path].map(|mode| {
        let mut plan = under(disc(40), &path);
        (plan.look.mode, plan.samples, plan.look.occlusion) = (mode, 16, 0.0);
        both(&plan).map(|frame| mean(&frame))
    });
    for (quick, followed) in quick.into_iter().zip(followed) {
        assert!((quick / followed - 1.0).abs() < 0.03, "{quick} {followed}");
    }
}

#[test]
fn a_sky_has_the_same_bits_in_blocks_and_slices() {
    let folder = Folder::new();
    let path = file(&folder, "sky.hdr", [64, 32], |x, y| {
        [x as f32, y as f32, 3.0]
    });
    let mut plan = under(sized("mandelbox-gate", [70, 44]), &path);
    (plan.samples, plan.look.mode, plan.look.fog) = (3, LightMode::Path, 0.5);
    bits_however_cut(&plan);
}
