//! Height maps by what the command line or a preset calls them: a file, or a field of
//! the program's own.

mod error;
mod file;
mod pattern_spec;
mod source;

pub use error::LoadError;
pub use pattern_spec::PatternSpec;
pub use source::{LoadOptions, Loaded, load};
