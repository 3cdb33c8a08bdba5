//! Image files as numbers, for pictures, height maps and cone maps.
//!
//! - [`open`]: a file and its format; [`png`], [`exr`], [`tiff`]: their numbers; [`hdr`]: light
//! - [`text_chunk`]: the texts in a PNG; [`texels`]: colours between pixels

pub mod exr;
pub mod hdr;
pub mod open;
pub mod png;
pub mod texels;
pub mod text_chunk;
pub mod tiff;
