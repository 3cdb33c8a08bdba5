//! Presets: the text of a Plan.
//!
//! - `builtin`: those of the program; `source`: one by its name, `file_text`: one in a file
//! - `document`, `read`: from TOML to a Plan; `write`: back; `beside`: back, for a file in
//!   another folder
//! - `error`: why a preset is wrong; `nearest`: the word that may have been meant
//! - `keys`: the list of all keys

#[cfg(feature = "cli")]
mod beside;
mod builtin;
mod document;
mod error;
#[cfg(feature = "cli")]
mod file_text;
mod keys;
mod nearest;
mod read;
mod source;
mod write;

#[cfg(feature = "cli")]
pub use beside::{move_beside, write_beside};
pub use builtin::{BUILTIN, builtin};
pub use document::{Override, SECTIONS};
pub use error::PresetError;
pub use keys::keys;
pub use nearest::nearest;
pub use read::{Preset, read};
pub use source::{PNG_KEYWORD, Source, file, find, load};
pub use write::write;
