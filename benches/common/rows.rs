//! What `benches/generators.rs` measures, and `benches/pages` shows.

use serde::{Deserialize, Serialize};

/// Nodes that a search looks at.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NodesRow {
    /// Name of the generator.
    pub generator: String,
    /// Name of the field.
    pub field: String,
    /// Samples along either axis.
    pub size: u32,
    /// Mean nodes per place.
    pub mean: f64,
    /// Nodes of the place that takes most.
    pub worst: u32,
}

/// Time of one map on a device.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SizesRow {
    /// Name of the generator; `max-mip` for the pyramid of maxima alone.
    pub generator: String,
    /// Samples along either axis.
    pub size: u32,
    /// Wall time in milliseconds, without compilation.
    pub ms: f64,
    /// Whether the map was given up, and the time is estimated from the share that was done.
    pub estimated: bool,
}

/// Times of one map, on a device and on the CPU.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TimesRow {
    /// Name of the generator.
    pub generator: String,
    /// Samples along either axis.
    pub size: u32,
    /// Name of the device.
    pub device: String,
    /// Wall time in milliseconds, without compilation.
    pub ms: f64,
    /// Milliseconds of the dispatches, including the reading of their results.
    pub dispatches_ms: f64,
    /// Whether the map was given up, and these times are estimated from the share that was
    /// done.
    pub estimated: bool,
    /// Share of the places whose ratio the CPU settled.
    pub settled: f64,
    /// Milliseconds on the CPU in f64.
    pub cpu_ms: f64,
    /// Whether the CPU's time is an estimate.
    pub cpu_estimated: bool,
    /// Bytes of the largest buffer that is bound: the tiles of the maxima.
    pub largest_binding: u64,
    /// Most bytes of memory that the process had before the CPU's turn, if the system tells.
    /// The memory of a software device is that of the process.
    pub peak: Option<u64>,
}
