//! Heightfields: height maps, maxima, cone maps and what traces them.

pub mod conemap;
pub mod field;
pub mod generate;
pub mod heights;
pub mod kept;
pub mod load;
pub mod mapfile;
pub mod maxmip;
pub mod paint;
pub mod patch;
pub mod placed;
pub mod raster;
pub mod relief;
pub mod shape;
pub mod source;
pub mod survey;
pub mod texture;
pub mod trace;
pub mod tracing;
pub mod under;
