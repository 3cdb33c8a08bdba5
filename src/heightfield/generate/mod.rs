//! Generators of cone maps: in f64 on the CPU, and on a device with the same result.

pub mod brute;
pub mod cost;
pub mod cpu;
pub mod device;
pub mod falling;
pub mod generator;
pub mod mips;
pub mod nine;
pub mod nine_device;
pub mod planes;
pub mod prepared;
pub mod program;
pub mod pyramid;
pub mod quick;
pub mod reach;
pub mod relaxed;
pub mod scan;
pub mod search;
pub mod settle;
pub mod slopes;
pub mod slopes_device;
pub mod uniform;
