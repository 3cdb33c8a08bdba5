//! The steps of a Plan. Every loop belongs to a pass; no pass knows what it marches.

pub mod color;
pub mod fog;
pub mod look;
pub mod march;
pub mod occlusion;
pub mod queue;
pub mod shadow;
pub mod trace;
