//! Heightfields: height maps, maxima, cone maps and what traces them.

pub mod conemap;
pub mod field;
pub mod generate;
pub mod heights;
pub mod maxmip;
pub mod patch;
pub mod relief;
pub mod survey;
pub mod trace;
