//! `conemarch bench`: the time that pictures take, and their errors.

use anyhow::Result;
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

/// Runs a measurement.
///
/// # Errors
/// An unknown preset or field, a device that fails, an unwritable file, an interrupt.
pub fn run(bench: &Bench) -> Result<()> {
    match bench {
        Bench::Error(args) => error::run(args),
        Bench::Steps(args) => steps::run(args),
        Bench::Cones(args) => cones::run(args),
        Bench::Calibrate(args) => calibrate::run(args),
    }
}
