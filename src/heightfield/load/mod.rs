//! Heights by the names that the command line and presets use: files and built-in patterns.

mod file;
mod pattern_spec;
mod source;

pub use pattern_spec::PatternSpec;
pub use source::{LoadOptions, Loaded, load};
