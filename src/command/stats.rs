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

/// What is known of the pixels of a picture, or of a part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tally {
    /// Pixels of sky, hits, and unconverged ones.
    pub states: [u64; 3],
    /// Pixels whose shadow ray reached its step limit.
    pub undecided: u64,
    /// The largest depth; infinite for sky.
    pub farthest: f32,
}

impl Tally {
    /// That of a frame.
    pub fn of(frame: &Frame) -> Self {
        Self {
            states: frame.census().map(|n| n as u64),
            undecided: frame.undecided as u64,
            farthest: frame.depth.iter().fold(0.0, |most: f32, t| most.max(*t)),
        }
    }

    /// That of two parts.
    pub fn and(self, other: Self) -> Self {
        Self {
            states: [0, 1, 2].map(|i| self.states[i] + other.states[i]),
            undecided: self.undecided + other.undecided,
            farthest: self.farthest.max(other.farthest),
        }
    }

    /// A number of pixels as a share of all, 0..1.
    fn share(&self, n: u64) -> f64 {
        n as f64 / self.states.iter().sum::<u64>().max(1) as f64
    }

    /// Shares of sky, hit and unconverged pixels, 0..1.
    fn shares(&self) -> [f64; 3] {
        self.states.map(|n| self.share(n))
    }
}

/// The figures of a render.
#[derive(Clone, Debug)]
pub struct Figures {
    /// Every pass in order.
    pub passes: Vec<PassFigures>,
    /// March and trace on the clock.
    pub march_ms: f64,
    /// How the host and the device worked together.
    pub traffic: Option<Traffic>,
    /// The pixels.
    pub tally: Tally,
}

impl Figures {
    /// Those of a frame.
    pub fn of(frame: &Frame) -> Self {
        Self {
            passes: frame.passes.clone(),
            march_ms: frame.march_ms,
            traffic: frame.traffic,
            tally: Tally::of(frame),
        }
    }

    /// Those of a picture of which nothing was left to render.
    pub fn none(tally: Tally) -> Self {
        Self {
            passes: Vec::new(),
            march_ms: 0.0,
            traffic: None,
            tally,
        }
    }

    /// Adds those of another part of the picture.
    pub fn add(&mut self, other: &Self) {
        self.march_ms += other.march_ms;
        self.tally = self.tally.and(other.tally);
        // Maps are made with the first part.
        let is_map = |p: &&PassFigures| matches!(p.pass, Pass::Prepare(_));
        let maps = other.passes.iter().take_while(is_map).count();
        let own = self.passes.iter_mut().skip_while(|p| is_map(&&**p));
        for (sum, part) in own.zip(&other.passes[maps..]) {
            sum.add(part);
        }
        if let (Some(sum), Some(part)) = (&mut self.traffic, &other.traffic) {
            sum.add(part);
        }
    }

    /// Evaluations and iterations of march and trace, if they were counted.
    fn work(&self) -> Option<[u64; 2]> {
        let marched = self.passes.iter().filter(|p| p.pass.marches());
        marched
            .map(|p| Some([p.evaluations?, p.iterations?]))
            .try_fold([0; 2], |sum, part| {
                part.map(|part| [sum[0] + part[0], sum[1] + part[1]])
            })
    }
}

impl Stats {
    /// The figures of a render.
    pub fn new(preset: &str, plan: &Plan, executor: &Executor, figures: &Figures) -> Self {
        let tally = &figures.tally;
        let work = figures.work().map(|sums| sums.map(|n| tally.share(n)));
        let [sky, hit, unconverged] = tally.shares();
        Self {
            preset: preset.into(),
            size: plan.pixels().size,
            device: executor.name(),
            backend: executor.backend(),
            mode: plan.march.mode.name(),
            wall_ms: figures.march_ms,
            passes: figures.passes.clone(),
            evaluations_per_pixel: work.map(|w| w[0]),
            iterations_per_pixel: work.map(|w| w[1]),
            hit,
            sky,
            unconverged,
            undecided: tally.share(tally.undecided),
            traffic: figures.traffic,
        }
    }
}

/// One line about a finished picture.
pub fn summary(output: &Path, [w, h]: [u32; 2], figures: &Figures) -> String {
    let color = figures.passes.iter().find(|p| p.pass == Pass::Color);
    let color = color.map_or(String::new(), |p| format!(", colour {:.0} ms", p.wall_ms));
    let made = figures.passes.iter();
    let made = made.filter(|p| matches!(p.pass, Pass::Prepare(_)));
    let made: Vec<f64> = made.map(|p| p.wall_ms).collect();
    let ms: f64 = made.iter().sum();
    let cones = match made.len() {
        0 => String::new(),
        1 => format!("cone map {ms:.0} ms, "),
        _ => format!("cone maps {ms:.0} ms, "),
    };
    let tally = &figures.tally;
    let [sky, hit, unconverged] = tally.shares().map(|s| 100.0 * s);
    let shadows = match 100.0 * tally.share(tally.undecided) {
        share if share < 0.05 => String::new(),
        share => {
            format!(", {share:.1} % of the pixels have a light ray that reached its step limit")
        }
    };
    format!(
        "{}  {w} x {h}  {cones}march and trace {:.0} ms{color}  hit {hit:.1} %, sky {sky:.1} %, unconverged {unconverged:.1} %{shadows}",
        shown(output),
        figures.march_ms
    )
}
