//! Compares the walk with the walk for distant views: `cargo run --release --example
//! distances`.
//!
//! The terrain of a preset, made of 1024 x 1024 samples of rough ground, is seen from farther
//! and farther away. The table has the texels that a pixel in the middle is wide, the steps
//! of both tracers' rays that come near the ground, alone and after cones, and how the
//! pictures differ: the share of pixels that are ground in one only, and among the others
//! how far apart their depths are, in pixel widths, for 50 and for 95 of 100.

use anyhow::Result;
use conemarch::compare::quantile;
use conemarch::cpu;
use conemarch::frame::{Frame, State};
use conemarch::mode::Mode;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{Override, load};

const FIELD: &str = "scene.field=\"fbm:1024x1024,seed=5,power=2.6\"";
/// The length of a texel, 1023 of which are the preset's block.
const TEXEL: f64 = 12.0 / 1023.0;
const SIZE: [u32; 2] = [640, 360];
const COUNTED: Extras = Extras {
    count: true,
    normals: false,
    levels: false,
    depth_only: true,
    time: false,
};
/// Times the distance of the preset's eye.
const FACTORS: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

fn main() -> Result<()> {
    let mut plans = Vec::new();
    for tracer in ["scene.tracer=walk", "scene.tracer=walk-mip"] {
        let set = [Override::read(FIELD)?, Override::read(tracer)?];
        plans.push(load("terrain", &set)?.plan);
    }
    let near = plans[0].camera.eye - plans[0].camera.target;
    println!(
        "| texels to a pixel | `walk` | `walk-mip` | after cones | | in one only | apart | 95 % |"
    );
    println!("|---:|---:|---:|---:|---:|---:|---:|---:|");
    for factor in FACTORS {
        let mut row = String::new();
        let mut frames = Vec::new();
        for mode in [Mode::Ray, Mode::Safe] {
            for plan in &mut plans {
                plan.size = SIZE;
                plan.camera.eye = plan.camera.target + factor * near;
                plan.march.mode = mode;
                let frame = cpu::render(plan, COUNTED, &mut |_| true)?;
                row += &format!(" {:.2} |", steps(&frame));
                frames.push(frame);
            }
        }
        let wide = plans[0].view().pixel * factor * near.length() / TEXEL;
        let (one, apart) = differences(&plans[0], &frames[0], &frames[1]);
        let [half, most] = [0.5, 0.95].map(|q| quantile(&apart, q));
        println!(
            "| {wide:.1} |{row} {:.2} % | {half:.2} | {most:.2} |",
            100.0 * one
        );
    }
    Ok(())
}

/// Mean steps of the rays that take any.
fn steps(frame: &Frame) -> f64 {
    let taken = frame.work.iter().map(|w| f64::from(w.evaluations));
    let some: Vec<f64> = taken.filter(|n| *n > 0.0).collect();
    some.iter().sum::<f64>() / some.len().max(1) as f64
}

/// The share of pixels that are hits of one frame only, and the differences of depth of the
/// others in pixel widths, sorted.
fn differences(plan: &Plan, a: &Frame, b: &Frame) -> (f64, Vec<f64>) {
    let hit = |f: &Frame, i: usize| f.state[i] == State::Hit as u8;
    let count = a.state.len();
    let one = (0..count).filter(|i| hit(a, *i) != hit(b, *i)).count();
    let ground = (0..count).filter(|i| hit(a, *i) || hit(b, *i)).count();
    let grain = plan.view().view_ray([0, 0]).grain;
    let both = (0..count).filter(|i| hit(a, *i) && hit(b, *i));
    let mut apart: Vec<f64> = both
        .map(|i| f64::from(a.depth[i] - b.depth[i]).abs() / f64::from(a.depth[i]) / (2.0 * grain))
        .collect();
    apart.sort_by(f64::total_cmp);
    (one as f64 / ground.max(1) as f64, apart)
}
