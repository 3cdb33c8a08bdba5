//! Heightfields: height maps, cone maps and the tracers that use them (docs/method.md, 4).
//!
//! - [`settings`], [`source`]: the keys of a heightfield, and where its heights come from
//! - [`assets`]: loads and makes what the settings name, and keeps it
//! - [`pattern`]: heights made from numbers; [`load`]: heights read from files
//! - [`file_error`]: why a file of heights or cones cannot be used
//! - [`heights`], [`patch`]: samples, and the surface between them
//! - [`height_surface`]: heights with their pyramid of maxima ([`max_mip`]);
//!   [`maxima_cone`]: how far a cone passes above the surface
//! - [`placement`]: from the world to texels and heights, and back
//! - [`conemap`]: cone maps, their generators and their files
//! - [`tracer`]: ways to find where a ray meets the surface
//! - [`paint`], [`texture`]: what colours the surface

pub mod assets;
pub mod conemap;
pub mod file_error;
pub mod height_surface;
pub mod heights;
pub mod load;
pub mod max_mip;
pub mod maxima_cone;
pub mod paint;
pub mod patch;
pub mod pattern;
pub mod placement;
pub mod settings;
pub mod source;
pub mod texture;
pub mod tracer;

pub use conemap::{ConeMap, MapKind};
pub use file_error::FileError;
pub use height_surface::HeightSurface;
pub use heights::{Heights, Normals, Patches};
pub use max_mip::MaxMip;
