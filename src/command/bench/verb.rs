//! The verbs of `conemarch bench`.

use anyhow::Result;
use clap::Subcommand;

use crate::command::bench::{calibrate, cones, error, steps};

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
