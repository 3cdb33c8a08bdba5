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
    ///
    /// A height map is a grid of heights, its samples. A texel is the distance between two samples.
    /// Four neighbouring samples are the corners of a cell. A cone map stores, for each sample or cell,
    /// how wide a cone that opens upwards there stays empty. The tip of the cone is its apex. The ratio
    /// is the radius of the cone over its height above the apex.
    Make(Box<make::Make>),
    /// Describe a cone map or a height map
    ///
    /// A cone map stores, for each place of a height map, how wide a cone that opens upwards there stays
    /// empty. The ratio is the radius of the cone over its height above the apex, its tip.
    Inspect(Box<inspect::Inspect>),
    /// Write a cone map in another layout or format
    ///
    /// A cone map stores, for each place of a height map, how wide a cone that opens upwards there stays
    /// empty. The ratio is the radius of the cone over its height above the apex, its tip.
    Convert(Box<convert::Convert>),
}
