//! `conemarch bench`: the time that pictures take, and their errors.

pub mod calibrate;
pub mod common;
pub mod cone_rows;
pub mod cones;
pub mod error;
pub mod plot;
pub mod row;
pub mod runner;
pub mod setting;
pub mod steps;
pub mod steps_row;
pub mod table;
pub mod verb;
