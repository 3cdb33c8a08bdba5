//! `conemarch bench`: what a picture costs and how wrong it is.

pub mod calibrate;
pub mod common;
pub mod cone_rows;
pub mod cones;
pub mod error;
pub mod plot;
pub mod row;
pub mod setting;
pub mod steps;
pub mod steps_row;
pub mod table;
pub mod verb;
