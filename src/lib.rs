//! Renders fractals and height maps on the GPU by multi-pass cone marching.
//!
//! A [`plan::Plan`] is everything that decides a picture. One of two executors renders it:
//! the GPU in f32 ([`gpu::render::Renderer`]) or the CPU in f64 ([`cpu::render`]). Both return a
//! [`picture::frame::Frame`]. Presets are the text of a Plan.
//!
//! # From a Plan to a PNG
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use conemarch::picture::{BitDepth, Layer, Shades, write_png};
//! use conemarch::{cpu, plan::Extras, preset, scene::Assets};
//!
//! let mut plan = preset::load("mandelbox", &[])?.plan;
//! plan.size = [64, 36];
//! let frame = cpu::render(&plan, &Assets::default(), Extras::default(), &mut |_| true)?;
//! let picture = Shades::new(Layer::Color, &frame, &plan);
//! let mut file = std::fs::File::create(std::env::temp_dir().join("mandelbox.png"))?;
//! let text = preset::write(&plan);
//! write_png(&mut file, &picture, BitDepth::Eight, &plan.title, &text)?;
//! # Ok(())
//! # }
//! ```
//!
//! # The map of the house
//!
//! Each module is a room with one purpose, and its own page lists what is in it. A room uses
//! only rooms on the floors below. From the ground up:
//!
//! | floor | room | what is in it |
//! |---|---|---|
//! | 1 | [`base`] | keys of presets, WGSL programs, rays and cones |
//! | 1 | [`raster`] | image files as numbers: PNG, EXR, TIFF, HDR |
//! | 2 | [`formula`] | shapes given by an estimate of the distance to them |
//! | 2 | [`heightfield`] | height maps, cone maps, and the tracers that use them |
//! | 2 | [`time`] | when the frames of a film are, and what settings are at a moment |
//! | 3 | [`scene`] | what there is to see, and what passes ask about it |
//! | 4 | [`plan`] | everything that decides a picture |
//! | 5 | [`preset`] | a Plan as TOML; the built-in presets |
//! | 5 | [`pass`] | the steps of a render: march, trace and colour |
//! | 6 | [`picture`] | the Frame, its layers, and files of them |
//! | 7 | [`gpu`] | the executor on a wgpu device |
//! | 7 | [`cpu`] | the executor on all cores |
//! | 8 | [`measure`] | truths, comparisons and calibration, for benchmarks |
//! | 9 | `preview` | the window |
//! | 10 | [`command`] | the command line |
//!
//! A Rust file and a WGSL file at the same path are twins: they compute the same functions,
//! in f64 and in f32. `docs/method.md` explains the mathematics.

pub mod base;
#[cfg(feature = "cli")]
pub mod command;
#[cfg(feature = "cli")]
pub mod cpu;
pub mod formula;
pub mod gpu;
pub mod heightfield;
#[cfg(feature = "cli")]
pub mod measure;
pub mod pass;
pub mod picture;
pub mod plan;
pub mod preset;
#[cfg(feature = "preview")]
pub mod preview;
pub mod raster;
pub mod scene;
pub mod time;
