//! Tracers: they find where a ray first meets a height surface. [`kind`] lists them.

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
pub use grid::{GridRay, Over};
pub use kind::{Accuracy, Steps, TracerKind};
