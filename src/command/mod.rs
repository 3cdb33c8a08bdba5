//! The command line: one verb in each file.

pub mod arguments;
pub mod bench;
pub mod completions;
pub mod conemap;
pub mod devices;
pub mod executor;
pub mod failure;
pub mod interrupt;
pub mod line;
pub mod memory;
pub mod output;
pub mod presets;
pub mod print;
pub mod progress;
pub mod render;
pub mod sink;
pub mod stats;
pub mod table;
