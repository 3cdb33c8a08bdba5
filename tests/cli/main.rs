//! The command line is a contract: every verb, every exit code, one sentence for every
//! error, and no file that should not be there. Presets are tested here too.
//!
//! Pictures are tiny and made by the CPU executor, so that no adapter is needed.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "tests are read by their names, and one that panics has failed"
)]

mod alpha;
mod bad_input;
mod bands;
mod bench;
mod films;
#[path = "../common/folder.rs"]
#[allow(dead_code, reason = "other files use the rest")]
mod folder;
#[path = "../common/pictures.rs"]
#[allow(dead_code, reason = "other files use the rest")]
mod images;
#[path = "../../benches/pages/presets.rs"]
mod page;
mod parts;
mod pictures;
mod preset_errors;
mod presets;
mod render;
mod sky;
mod stereo;
mod streams;
mod tools;
mod verbs;
