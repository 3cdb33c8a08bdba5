//! `conemarch conemap make|inspect|convert`

use anyhow::Result;
use clap::Subcommand;

mod convert;
mod describe;
mod inspect;
mod make;
pub mod maker;
mod options;
mod panels;
mod sheet;

/// What `conemap` can do.
#[derive(Debug, Subcommand)]
pub enum ConeMapVerb {
    /// Make a cone map from heights
    Make(Box<make::Make>),
    /// Describe a cone map or a height map
    Inspect(Box<inspect::Inspect>),
    /// Write a cone map in another layout or format
    Convert(Box<convert::Convert>),
}

/// Runs one.
///
/// # Errors
/// As the verb says.
pub fn run(verb: &ConeMapVerb) -> Result<()> {
    match verb {
        ConeMapVerb::Make(args) => make::run(args),
        ConeMapVerb::Inspect(args) => inspect::run(args),
        ConeMapVerb::Convert(args) => convert::run(args),
    }
}
