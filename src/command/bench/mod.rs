//! `conemarch bench`: the time that pictures take, and their errors.

use clap::Subcommand;

pub mod calibrate;
pub mod common;
pub mod cone_rows;
pub mod cones;
pub mod error;
pub mod files;
pub mod plot;
pub mod row;
pub mod runner;
pub mod setting;
pub mod steps;
pub mod steps_row;
pub mod table;

/// What to measure.
#[derive(Debug, Subcommand)]
pub enum Bench {
    /// Time and error of every mode against the truth
    Error(error::ErrorBench),
    /// Evaluations, iterations and lane waste of every pass
    Steps(steps::StepsBench),
    /// Cone maps and tracers of heightfields: time, width, steps, missed hits
    Cones(cones::ConesBench),
    /// Propose lipschitz, shell and fudge for a budget of lost pixels
    Calibrate(calibrate::CalibrateBench),
}
