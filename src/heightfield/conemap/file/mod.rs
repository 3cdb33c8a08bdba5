//! Cone maps in files: the layouts of the papers, rounded so that no cone becomes wider,
//! with a label that says what the map is and which heights it belongs to.
//!
//! - `format`: the layouts, and what their channels hold
//! - `map_file`: a map with what its file knows of it; `label`: that as text
//! - `encode`, `decode`: a map to the bytes of a file, and back
//! - `rounding`: ratios and heights as whole numbers; `shading`: slopes and normals
//! - `compatibility`: whether a map fits heights and a tracer

mod compatibility;
mod decode;
mod encode;
mod format;
mod label;
mod map_file;
mod rounding;
mod shading;

pub use compatibility::MapUse;
pub(crate) use decode::decode_as;
pub use decode::{ForeignFormat, decode, decode_bytes, has_map, read_map};
pub use encode::encode;
pub use format::{Channel, Layout, MapFormat, RatioScale, Slopes};
pub use map_file::{Label, MapFile, ShadingChannel, digest};
pub use rounding::{Ratios, narrowed, share_down};
