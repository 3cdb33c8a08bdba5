//! Tracers: where a ray first meets a relief.

mod any;
pub mod cones;
mod contract;
pub mod course;
pub mod linear;
pub mod max_mip;
pub mod oracle;
pub mod refine;
pub mod relaxed;
pub mod settings;
pub mod walk;
pub mod walk_mip;

pub use any::AnyTracer;
pub use contract::{
    BASE, FACE_BITS, LocalRay, SURFACE, Step, Trace, TraceError, TraceHit, Tracer, WALL_X_HIGH,
    WALL_X_LOW, WALL_Y_HIGH, WALL_Y_LOW,
};
