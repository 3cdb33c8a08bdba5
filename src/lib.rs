//! Multi-pass cone marching of distance-estimated fractals.
pub mod cone;
pub mod cpu;
pub mod formula;
pub mod frame;
pub mod gpu;
pub mod key;
pub mod mode;
pub mod pass;
pub mod plan;
pub mod pyramid;
pub mod render;
pub mod scene;
pub mod shader;
pub mod view;
