//! Generators of cone maps, in f64 on the CPU and in f32 on a device, with the same result.
//!
//! [`generator`] lists the generators, and a [`ConeSearch`] is how one of them searches.
//! A new generator is one entry in the list; a new method is one Rust file and one WGSL file.

pub mod brute;
pub mod cone_search;
pub mod cost;
pub mod cpu;
pub mod falling;
pub mod generator;
pub mod grid_distance;
pub mod min3x3;
pub mod mips;
pub mod planes;
pub mod pyramid;
pub mod quick;
pub mod refine_f64;
pub mod relaxed;
pub mod rings;
pub mod search;
pub mod slopes;
pub mod task;
pub mod uniform;

pub use cone_search::{Apex, ConeSearch};
pub use cost::Cost;
pub use generator::{GenerateError, Generator, Options};
pub use rings::rings;
pub use search::Best;
pub use task::MapTask;
pub use uniform::SearchState;
