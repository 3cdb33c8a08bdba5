//! Multi-pass cone marching of distance-estimated fractals on wgpu compute.
//!
//! One value, the [`plan::Plan`], goes to either of two executors, the GPU
//! ([`gpu::render::Renderer`], f32) or the CPU ([`cpu::render`], f64), and both return the
//! same value, a [`picture::frame::Frame`]. Presets are the text of a Plan, the truth is a
//! Plan, and every claim about error is a comparison of two Frames ([`measure::compare`]).

pub mod base;
pub mod command;
pub mod cpu;
pub mod formula;
pub mod gpu;
pub mod heightfield;
pub mod measure;
pub mod pass;
pub mod picture;
pub mod plan;
pub mod preset;
pub mod scene;
