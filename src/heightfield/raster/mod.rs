//! Image files as numbers, which height maps and cone maps are read from.

pub mod exr;
pub mod open;
pub mod png;
pub mod tiff;
