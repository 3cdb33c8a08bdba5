//! The rows of `bench cones`: a map of a field, and a tracer over a view of one.

use serde::{Deserialize, Serialize};

/// One map of one field. Ratios are in texture widths over whole heights.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GeneratorRow {
    /// Name of the field.
    pub field: String,
    /// Samples along each axis.
    pub size: [u32; 2],
    /// `bilinear` patches between the samples, or `boxes`.
    pub surface: String,
    /// Who makes it.
    pub generator: String,
    /// On what.
    pub device: String,
    /// Time on the clock; null where the budget ran out.
    pub ms: Option<f64>,
    /// Mean ratio, none counted as wider than the texture.
    pub mean_ratio: Option<f64>,
    /// The same over that of `brute`.
    pub of_exact: Option<f64>,
    /// Share of samples with a cone over a millionth wider than `brute` has; null for maps
    /// of another kind.
    pub wider_than_exact: Option<f64>,
    /// What it would have taken, where the budget ran out.
    pub estimate_ms: Option<f64>,
}

/// One tracer over one view.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TracerRow {
    /// Name of the field.
    pub field: String,
    /// Samples along each axis.
    pub size: [u32; 2],
    /// `bilinear` patches between the samples, or `boxes`.
    pub surface: String,
    /// Angle from the vertical.
    pub view_deg: u32,
    /// Who traces.
    pub tracer: String,
    /// Generator of its cones.
    pub map: String,
    /// Mean steps of a ray.
    pub steps_mean: f64,
    /// Steps that 99 of 100 rays need at most.
    pub steps_p99: u32,
    /// Share of rays whose hit lies over one texel behind the true one, or is none.
    pub skipped: f64,
    /// Share of rays that run out of steps.
    pub unconverged: f64,
    /// Mean distance of the other hits from the true ones.
    pub error_texels: f64,
}
