//! Heightfields: height maps, maxima, cone maps and what traces them.

pub mod assets;
pub mod conemap;
pub mod height_surface;
pub mod heights;
pub mod load;
pub mod max_mip;
pub mod paint;
pub mod patch;
pub mod pattern;
pub mod placement;
pub mod raster;
pub mod region_max;
pub mod settings;
pub mod source;
pub mod texture;
pub mod tracer;
