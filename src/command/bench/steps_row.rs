//! One row of `bench steps`: a pass of a preset in a mode.

use serde::{Deserialize, Serialize};

/// One pass of one preset in one mode. Quantiles are of evaluations per visited cell.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct StepsRow {
    /// Name of the preset.
    pub preset: String,
    /// Mode of the march.
    pub mode: String,
    /// `march 1/16` or `trace`.
    pub pass: String,
    /// Pixels along each axis.
    pub size: [u32; 2],
    /// Who rendered.
    pub device: String,
    /// Cells of the level.
    pub cells: u64,
    /// Cells that were evaluated: the others lie under sky.
    pub visited: u64,
    /// Estimate evaluations.
    pub evaluations: u64,
    /// Fold iterations.
    pub iterations: u64,
    /// Half of the visited cells need at most so many evaluations.
    pub p50: u32,
    /// As `p50`, of 90 %.
    pub p90: u32,
    /// As `p50`, of 99 %.
    pub p99: u32,
    /// The most evaluations of a cell.
    pub max: u32,
    /// Share of all cells that are proven sky, or lie under such a cell.
    pub sky: f64,
    /// Share of all cells that reached the step limit.
    pub unconverged: f64,
    /// Evaluations of tiles of 8 x 1 cells whose lanes all run until the last one is done, over
    /// those that the lanes need. A processor with AVX has groups of 8 lanes.
    pub waste_8x1: f64,
    /// The same for 8 x 4: many GPUs have groups of 32 lanes.
    pub waste_8x4: f64,
    /// Visited cells by evaluations: 0, 1, 2, 3-4, 5-8, and so on by doubling.
    pub histogram: Vec<u64>,
    /// Time on the device, where it has timestamps; median of warm runs.
    pub gpu_ms: Option<f64>,
    /// Time on the clock; median of warm runs.
    pub wall_ms: f64,
    /// A warning if f32 is not precise enough for the preset.
    pub precision: Option<String>,
}
