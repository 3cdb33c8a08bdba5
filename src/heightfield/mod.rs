//! Heightfields: height maps, maxima, cone maps and what traces them.

pub mod conemap;
pub mod field;
pub mod generate;
pub mod heights;
pub mod load;
pub mod mapfile;
pub mod maxmip;
pub mod patch;
pub mod raster;
