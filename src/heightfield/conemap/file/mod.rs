//! Cone maps in files: the layouts of the papers, rounded so that no cone becomes wider,
//! with a label that says what the map is and which heights it belongs to.

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
pub use format::{Bits, Channel, Layout, MapFormat, RatioScale, Slopes};
pub use map_file::{Label, MapFile, ShadingChannel, digest};
pub use rounding::{Ratios, narrowed};
