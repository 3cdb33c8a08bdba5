//! `conemarch conemap make|inspect|convert`
//!
//! - [`make`], [`inspect`], [`convert`]: the verbs; `options`: what they share
//! - [`maker`]: makes maps on a device or on the CPU
//! - `describe`: what is in a file, as text
//! - `panels`: its channels as pictures; `sheet`: pictures side by side

use clap::Subcommand;

pub mod convert;
mod describe;
pub mod inspect;
pub mod make;
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
