//! Time: when the frames of a film are, and what settings are at a moment.
//!
//! - [`clock`]: length, frames and beats of a film
//! - [`track`]: the values of one setting over time
//! - [`pose`]: the path of a camera

pub mod clock;
pub mod pose;
pub mod track;
