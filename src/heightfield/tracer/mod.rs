//! Tracers: they find where a ray first meets a height surface.
//!
//! - [`kind`]: the list of tracers, and what is known of each before it is made
//! - `contract`: [`Tracer`] and [`Method`], what a scene asks, and the state of a ray
//! - [`settings`]: which tracer a preset chooses, its cones, and its numbers
//! - [`walk`], [`relaxed`]: the cone walk, and with relaxed cones; [`walk_mip`]: over distant nodes
//! - [`max_mip`]: descent of the pyramid of maxima
//! - [`cones`]: cone steps over samples; [`linear`]: equal steps
//! - [`mod@reference`]: solves every cell; all others are measured against it
//! - [`grid`]: a ray's way from cell to cell; [`cone`]: how far a cone lets it go on
//! - [`mod@refine`]: from a bracket to a hit

pub mod cone;
pub mod cones;
mod contract;
pub mod grid;
pub mod kind;
pub mod linear;
pub mod max_mip;
pub mod reference;
pub mod refine;
pub mod relaxed;
pub mod settings;
pub mod walk;
pub mod walk_mip;

pub use contract::{
    BASE, FACE_BITS, LocalRay, Method, SURFACE, Step, Trace, TraceError, TraceHit, Tracer,
    WALL_X_HIGH, WALL_X_LOW, WALL_Y_HIGH, WALL_Y_LOW,
};
pub use grid::{GridRay, NodeSpan};
pub use kind::{Accuracy, Steps, TracerKind};
