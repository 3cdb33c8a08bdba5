//! Generators of cone maps, in f64 on the CPU and in f32 on a device, with the same result.
//!
//! - [`generator`]: the list of generators, and their options
//! - [`cone_search`]: the trait of how one of them searches; [`task`]: what a search reads
//! - [`brute`]: in growing [`mod@rings`]; [`search`]: by branch and bound, with [`planes`]
//! - [`quick`]: over neighbours in each level; [`relaxed`]: along rays
//! - [`cost`]: how wide a cone a place allows; [`grid_distance`]: how far away the place is
//! - [`falling`]: places that limit relaxed cones
//! - [`cpu`]: whole maps in f64; [`refine_f64`]: ratios of what a device has found
//! - [`pyramid`]: the maxima in a buffer; [`uniform`]: parameters and results of the kernels
//! - [`min3x3`]: the least cone of nine; [`mips`]: the cones of nodes
//! - [`mod@slopes`]: slopes at the samples
//!
//! A new generator is one entry in the list; a new search is one Rust file and one WGSL file.

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
