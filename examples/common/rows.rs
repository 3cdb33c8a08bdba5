//! What `examples/generators.rs` measures, as `examples/heightfields` reads it.

use serde::{Deserialize, Serialize};

/// Nodes that a search looks at.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NodesRow {
    /// Who searches.
    pub generator: String,
    /// Name of the field.
    pub field: String,
    /// Samples along either axis.
    pub size: u32,
    /// Nodes per place.
    pub mean: f64,
    /// Nodes of the place that takes most.
    pub worst: u32,
}

/// Time of one map on a device.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SizesRow {
    /// Who makes it; `max-mip` for the pyramid of maxima alone.
    pub generator: String,
    /// Samples along either axis.
    pub size: u32,
    /// Milliseconds on the clock, without compilation.
    pub ms: f64,
    /// Whether that is of a map that was given up, from the share that was done.
    pub estimated: bool,
}

/// Times of one map, on a device and on the CPU.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TimesRow {
    /// Who makes it.
    pub generator: String,
    /// Samples along either axis.
    pub size: u32,
    /// On what.
    pub device: String,
    /// Milliseconds on the clock, without compilation.
    pub ms: f64,
    /// Milliseconds of the dispatches, each with the reading of what it found.
    pub dispatches_ms: f64,
    /// Whether these are of a map that was given up, from the share that was done.
    pub estimated: bool,
    /// Share of the places that were settled on the CPU.
    pub settled: f64,
    /// Milliseconds on the CPU in f64.
    pub cpu_ms: f64,
    /// Whether that is from a share, too.
    pub cpu_estimated: bool,
    /// Bytes of the largest buffer that is bound: the tiles of the maxima.
    pub largest_binding: u64,
    /// Most bytes of memory that the process has had before the CPU's turn, where the
    /// system tells. A software device's memory is the process's.
    pub peak: Option<u64>,
}
