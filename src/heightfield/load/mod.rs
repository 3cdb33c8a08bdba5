//! Heights by the names that the command line and presets use: files and built-in patterns.
//!
//! - `source`: from an argument to heights, by [`load`]
//! - `file`: the numbers in a file; `pattern_spec`: patterns as one word

mod file;
mod pattern_spec;
mod source;

pub use pattern_spec::PatternSpec;
pub use source::{LoadOptions, Loaded, load};
