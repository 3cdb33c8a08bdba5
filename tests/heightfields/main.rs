//! Heightfields: their tracers, in Rust and on a device, and their scenes on both executors.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

#[path = "../adapter/mod.rs"]
mod adapter;
mod cases;
mod closed_forms;
#[path = "../common"]
#[allow(dead_code, reason = "other crates use the rest")]
mod common {
    pub mod cones;
    pub mod folder;
    pub mod overclaims;
    pub mod pictures;
    pub mod probe;
    pub mod random;
    pub mod reference_maps;
}
mod boxes;
mod cones;
mod distant;
mod first_hits;
mod limits;
mod normals;
mod paint;
mod scenes;
mod statistics;
mod textures;
mod twins;

use conemarch::picture::frame::Frame;
use conemarch::plan::camera::Camera;
use conemarch::plan::{Extras, Plan};
use conemarch::preset;

/// A plan of a heightfield, seen from above. `scene` has the lines of its `[scene]`.
fn plan(scene: &str) -> Plan {
    let text = format!("[scene]\nkind = 'heightfield'\n{scene}");
    let mut plan = preset::read(&text, "test").unwrap_or_else(|e| panic!("{text}: {e}"));
    plan.camera = camera([5.0, -9.0, 7.0], [0.0, 0.3, 0.5], 40.0);
    (plan.size, plan.samples) = ([120, 80], 1);
    plan
}

fn camera(eye: [f64; 3], target: [f64; 3], fov: f64) -> Camera {
    Camera {
        eye: eye.into(),
        target: target.into(),
        up: glam::DVec3::Z,
        fov,
        ..Camera::default()
    }
}

/// The frames of a plan on the CPU and on the device.
fn both(plan: &Plan, extras: Extras) -> [Frame; 2] {
    [adapter::on_cpu(plan, extras), adapter::render(plan, extras)]
}

/// The number of pixels whose colours are apart by more than a tolerance.
fn apart(a: &Frame, b: &Frame, tolerance: f32) -> usize {
    let pairs = a.radiance.iter().zip(&b.radiance);
    let differ = |(a, b): &(&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > tolerance);
    pairs.filter(differ).count()
}
