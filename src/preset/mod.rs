//! Presets: the text of a Plan.
//!
//! - `builtin`: those of the program; `source`: one by its name, `file_text`: one in a file
//! - `document`, `read`: from TOML to a Plan; `write`: back
//! - `error`: why a preset is wrong; `nearest`: the word that may have been meant
//! - `reference`: the page of all keys

mod builtin;
mod document;
mod error;
#[cfg(feature = "cli")]
mod file_text;
mod nearest;
mod read;
mod reference;
mod source;
mod write;

pub use builtin::{BUILTIN, builtin};
pub use document::Override;
pub use error::PresetError;
pub use nearest::nearest;
pub use read::{Preset, read};
pub use reference::{keys, reference};
pub use source::{PNG_KEYWORD, Source, file, find, load};
pub use write::write;
