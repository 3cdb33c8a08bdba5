//! Pictures on their way out: layers as pixels, file formats, and files that appear whole
//! or not at all.
//!
//! - [`frame`]: what a render yields; `layer`: a layer of it as pixels
//! - `bloom`: light that a lens spreads over the picture
//! - `stereo`: two frames side by side
//! - `png`, `exr`, `web` (JPEG and WebP): files of pictures
//! - `place`: a file that appears whole or not at all; `folder`: where it goes
//! - `error`: why a picture cannot be written

mod bloom;
mod error;
mod exr;
#[cfg(feature = "cli")]
mod folder;
pub mod frame;
mod layer;
#[cfg(feature = "cli")]
mod place;
mod png;
mod stereo;
mod web;

pub use bloom::{Bloom, SummedLight};
pub use error::OutputError;
#[cfg(feature = "cli")]
pub use error::is_full;
pub use exr::{
    FAR, Named, exr_names, exr_row_bytes, exr_rows, exr_rows_of, write_exr, write_exr_part,
    write_exr_rows,
};
#[cfg(feature = "cli")]
pub use folder::Folder;
pub use layer::{Layer, LayerFacts, Shades, heat};
#[cfg(feature = "cli")]
pub use place::{Place, clear, commit, keep, set_unfinished};
pub use png::{LAYER_KEYWORD, PngHead, write_png, write_png_rows};
pub use stereo::beside;
pub use web::{write_jpeg, write_webp};

pub use crate::raster::png::BitDepth;

/// The program as pictures name it.
pub(crate) const SOFTWARE: &str = concat!("conemarch ", env!("CARGO_PKG_VERSION"));
