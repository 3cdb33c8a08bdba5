//! Height maps, cone maps and their files, from the library and from the command line.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test fails by panicking, and has no readers of its interface"
)]

#[path = "../adapter/mod.rs"]
mod adapter;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "../common/folder.rs"]
mod folder;
#[path = "../common/pictures.rs"]
mod pictures;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "../common/programs.rs"]
mod programs;
#[allow(dead_code, reason = "other tests use the rest")]
#[path = "../common/reference_maps.rs"]
mod reference_maps;

mod commands;
mod devices;
mod fields;
mod generators;
mod height_files;
mod labels;
mod map_files;
mod misuse;
mod pyramids;
