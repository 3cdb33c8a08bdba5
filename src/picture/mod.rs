//! Pictures on their way out: layers as pixels, file formats, and safe places.

mod error;
mod exr;
mod folder;
pub mod frame;
mod layer;
mod map;
mod place;
mod png;

pub use error::OutputError;
pub use exr::write_exr;
pub use folder::Folder;
pub(crate) use layer::heat;
pub use layer::{Layer, Shades};
pub use map::{WriteMapError, write_map};
pub use place::{Place, clear, commit};
pub use png::{BitDepth, write_png};
