//! Generators of cone maps: in f64 on the CPU, and on a device with the same result.

pub mod brute;
pub mod cost;
pub mod cpu;
pub mod falling;
pub mod generator;
pub mod grid_distance;
pub mod min3x3;
pub mod mips;
pub mod planes;
pub mod program;
pub mod pyramid;
pub mod quick;
pub mod refine_f64;
pub mod relaxed;
pub mod scan;
pub mod search;
pub mod slopes;
pub mod task;
pub mod uniform;
