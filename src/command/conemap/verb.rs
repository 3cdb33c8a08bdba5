//! The sub-verbs of `conemap`.

use anyhow::Result;
use clap::Subcommand;

use super::{convert, inspect};

/// What `conemap` can do.
#[derive(Debug, Subcommand)]
pub enum ConeMapVerb {
    // M1
    // M2
    /// Tell what is in a cone map or in a height map
    Inspect(Box<inspect::Inspect>),
    /// Write a cone map in another layout or format
    Convert(Box<convert::Convert>),
}

/// Runs one.
///
/// # Errors
/// What the sub-verb says.
pub fn run(verb: &ConeMapVerb) -> Result<()> {
    match verb {
        // M3
        ConeMapVerb::Inspect(args) => inspect::run(args),
        ConeMapVerb::Convert(args) => convert::run(args),
    }
}
