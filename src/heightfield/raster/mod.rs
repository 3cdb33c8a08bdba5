//! Image files as numbers, which height maps and cone maps are read from.
//!
//! - [`mod@open`]: the format of a file, by its first bytes
//! - [`png`]: whole numbers; [`exr`]: floats by channel; [`tiff`]: both

pub mod exr;
pub mod open;
pub mod png;
pub mod tiff;
