//! The rows of `bench cones`: one kind for maps, one for tracers.

use serde::{Deserialize, Serialize};

use crate::measure::tracer_stats::TracerStats;

/// A row of either kind, as a file has it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ConesRow {
    /// A map of a field.
    Generator(GeneratorRow),
    /// A tracer over a view of a field.
    Tracer(TracerRow),
}

/// A surface.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SurfaceNote {
    /// Name of the field.
    pub field: String,
    /// Samples along each axis.
    pub size: [u32; 2],
    /// `bilinear` patches between the samples, or `boxes`.
    pub surface: String,
}

/// One map of one field. Ratios are in texture widths over whole heights.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct GeneratorRow {
    /// What it was made for.
    #[serde(flatten)]
    pub over: SurfaceNote,
    /// The generator.
    pub generator: String,
    /// The device that makes it.
    pub device: String,
    /// Wall time; null if it exceeds the time limit.
    pub ms: Option<f64>,
    /// Mean ratio; none counts as wider than the texture.
    pub mean_ratio: Option<f64>,
    /// The mean ratio over that of `brute`.
    pub of_exact: Option<f64>,
    /// Share of samples whose cone is wider than that of `brute` by over a millionth; null for
    /// maps of another kind.
    pub wider_than_exact: Option<f64>,
    /// The estimated wall time of a map that exceeds the time limit.
    pub estimate_ms: Option<f64>,
}

/// One tracer over one view.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TracerRow {
    /// What it was traced over.
    #[serde(flatten)]
    pub over: SurfaceNote,
    /// Angle from the vertical.
    pub view_deg: u32,
    /// The tracer.
    pub tracer: String,
    /// The generator of its cones.
    pub map: String,
    /// What it costs and misses.
    #[serde(flatten)]
    pub stats: TracerStats,
}
