//! The figures of a render, as JSON and as a line.

use std::path::Path;

use serde::Serialize;

use crate::command::executor::Executor;
use crate::command::sink::shown;
use crate::picture::frame::{Frame, PassFigures, Traffic};
use crate::plan::{Pass, Plan};

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
    pub passes: Vec<PassFigures>,
    /// Evaluations of march and trace per pixel.
    pub evaluations_per_pixel: Option<f64>,
    /// Iterations of march and trace per pixel.
    pub iterations_per_pixel: Option<f64>,
    /// Share of pixels that met the surface, 0..1.
    pub hit: f64,
    /// Share of pixels that met nothing, 0..1.
    pub sky: f64,
    /// Share of pixels that reached a limit, 0..1.
    pub unconverged: f64,
    /// Share of pixels whose shadow ray reached its step limit, 0..1.
    pub undecided: f64,
    /// How the host and the device worked together.
    #[serde(flatten)]
    pub traffic: Option<Traffic>,
}

impl Stats {
    /// The figures of a frame.
    pub fn new(preset: &str, plan: &Plan, executor: &Executor, frame: &Frame) -> Self {
        let work = frame.work_per_pixel();
        let [sky, hit, unconverged] = shares(frame);
        Self {
            preset: preset.into(),
            size: frame.size,
            device: executor.name(),
            backend: executor.backend(),
            mode: plan.march.mode.name(),
            wall_ms: frame.march_ms,
            passes: frame.passes.clone(),
            evaluations_per_pixel: work.map(|w| w.0),
            iterations_per_pixel: work.map(|w| w.1),
            hit,
            sky,
            unconverged,
            undecided: undecided(frame),
            traffic: frame.traffic,
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

/// One line about a finished picture.
pub fn summary(output: &Path, frame: &Frame) -> String {
    let [w, h] = frame.size;
    let color = frame.passes.iter().find(|p| p.pass == Pass::Color);
    let color = color.map_or(String::new(), |p| format!(", colour {:.0} ms", p.wall_ms));
    let made = frame.passes.iter();
    let made = made.filter(|p| matches!(p.pass, Pass::Prepare(_)));
    let made: Vec<f64> = made.map(|p| p.wall_ms).collect();
    let ms: f64 = made.iter().sum();
    let cones = match made.len() {
        0 => String::new(),
        1 => format!("cone map {ms:.0} ms, "),
        _ => format!("cone maps {ms:.0} ms, "),
    };
    let [sky, hit, unconverged] = shares(frame).map(|s| 100.0 * s);
    let shadows = match 100.0 * undecided(frame) {
        share if share < 0.05 => String::new(),
        share => format!(", shadow ray out of steps {share:.1} %"),
    };
    format!(
        "{}  {w} x {h}  {cones}march and trace {:.0} ms{color}  hit {hit:.1} %, sky {sky:.1} %, unconverged {unconverged:.1} %{shadows}",
        shown(output),
        frame.march_ms
    )
}
