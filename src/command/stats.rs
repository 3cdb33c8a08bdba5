//! The figures of a render as JSON.

use serde::Serialize;

use crate::command::executor::Executor;
use crate::picture::frame::Frame;
use crate::plan::Plan;

/// One render.
#[derive(Clone, Debug, Serialize)]
pub struct Stats {
    /// Name of the preset.
    pub preset: String,
    /// Pixels along each axis.
    pub size: [u32; 2],
    /// Who rendered.
    pub device: String,
    /// `vulkan`, `metal`, `dx12` or `cpu`.
    pub backend: String,
    /// Mode of the march.
    pub mode: &'static str,
    /// March and trace on the clock, without compilation and files.
    pub wall_ms: f64,
    /// Every pass in order.
    pub passes: Vec<PassStats>,
    /// Evaluations of march and trace over pixels.
    pub evaluations_per_pixel: Option<f64>,
    /// Fold iterations of march and trace over pixels.
    pub iterations_per_pixel: Option<f64>,
    /// Share of pixels that met the surface, 0..1.
    pub hit: f64,
    /// Share of pixels that met nothing, 0..1.
    pub sky: f64,
    /// Share of pixels that reached a limit, 0..1.
    pub unconverged: f64,
    /// Share of pixels whose shadow's ray did, 0..1.
    pub undecided: f64,
}

/// One pass.
#[derive(Clone, Debug, Serialize)]
pub struct PassStats {
    /// `prepare`, `march 1/16`, `trace` or `color`.
    pub name: String,
    /// Cells or pixels; places of a cone map.
    pub cells: u64,
    /// Time on the clock.
    pub wall_ms: f64,
    /// Time on the device, where it tells.
    pub gpu_ms: Option<f64>,
    /// Estimate evaluations, where they were counted.
    pub evaluations: Option<u64>,
    /// Fold iterations, where they were counted.
    pub iterations: Option<u64>,
}

impl Stats {
    /// The figures of a frame.
    pub fn new(preset: &str, plan: &Plan, executor: &Executor, frame: &Frame) -> Self {
        let work = frame.work_per_pixel();
        let [sky, hit, unconverged] = shares(frame);
        let passes = frame.passes.iter().map(|p| PassStats {
            name: p.pass.name(),
            cells: p.cells,
            wall_ms: p.wall_ms,
            gpu_ms: p.gpu_ms,
            evaluations: p.evaluations,
            iterations: p.iterations,
        });
        Self {
            preset: preset.into(),
            size: frame.size,
            device: executor.name(),
            backend: executor.backend(),
            mode: plan.march.mode.name(),
            wall_ms: frame.march_ms,
            passes: passes.collect(),
            evaluations_per_pixel: work.map(|w| w.0),
            iterations_per_pixel: work.map(|w| w.1),
            hit,
            sky,
            unconverged,
            undecided: undecided(frame),
        }
    }
}

/// Share of pixels whose shadow's ray reached its limit, 0..1.
pub fn undecided(frame: &Frame) -> f64 {
    frame.undecided as f64 / frame.state.len().max(1) as f64
}

/// Shares of sky, hit and unconverged pixels, 0..1.
pub fn shares(frame: &Frame) -> [f64; 3] {
    let all = frame.state.len().max(1) as f64;
    frame.census().map(|n| n as f64 / all)
}
