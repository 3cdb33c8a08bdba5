//! The command line: its verbs, and what they share.
//!
//! - [`mod@line`]: the command line as a whole; [`arguments`]: parsers of arguments
//! - [`render`], [`merge`], `preview`, [`animate`], [`mod@bench`], [`conemap`], [`presets`], [`devices`], [`completions`]: the verbs
//! - [`executor`]: the device or the CPU that `--device` chooses
//! - [`bands`]: big pictures, with their finished bands in a file, [`unfinished`]; [`tile`]: parts of a
//!   picture
//! - [`frames`]: the files of a film's frames
//! - [`memory`]: checks before the work that a picture fits
//! - [`output`]: where a render writes, and how; [`sink`]: files and standard output
//! - [`progress`]: how much is done; [`mod@print`]: standard output and standard error
//! - [`stats`]: the figures of a render; [`table`]: rows of cells as text
//! - [`failure`]: errors as sentences and exit codes; [`interrupt`]: requests to end

pub mod animate;
pub mod arguments;
pub mod bands;
pub mod bench;
pub mod completions;
pub mod conemap;
pub mod devices;
pub mod executor;
pub mod failure;
pub mod frames;
pub mod interrupt;
pub mod line;
pub mod memory;
pub mod merge;
pub mod output;
pub mod presets;
#[cfg(feature = "preview")]
pub mod preview;
pub mod print;
pub mod progress;
pub mod render;
pub mod sink;
pub mod stats;
pub mod table;
pub mod tile;
pub mod unfinished;
