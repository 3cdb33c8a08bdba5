//! Multi-pass cone marching of distance-estimated fractals on wgpu compute.
//!
//! One value, the [`plan::Plan`], goes to either of two executors, the GPU
//! ([`render::Renderer`], f32) or the CPU ([`cpu::render`], f64), and both return the
//! same value, a [`frame::Frame`]. Presets are the text of a Plan, the truth is a Plan,
//! and every claim about error is a comparison of two Frames ([`compare`]).

pub mod calibrate;
pub mod command;
pub mod compare;
pub mod cone;
pub mod cpu;
pub mod flip;
pub mod formula;
pub mod frame;
pub mod gpu;
pub mod heightfield;
pub mod key;
pub mod mode;
pub mod output;
pub mod pass;
pub mod plan;
pub mod preset;
pub mod pyramid;
pub mod render;
pub mod scene;
pub mod shader;
pub mod srgb;
pub mod truth;
pub mod view;
