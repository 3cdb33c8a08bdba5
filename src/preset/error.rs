//! Errors of presets: one sentence that says where, what is wrong, and what to write instead.

use thiserror::Error;

use crate::preset::nearest::perhaps;

/// An error of a preset, of an override, or of the argument that names a preset.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PresetError {
    /// The text is wrong.
    #[error("{}: {why}", place(.origin, *.line))]
    Content {
        /// File or built-in preset.
        origin: String,
        /// Line in it, from 1; `None` if something is missing.
        line: Option<usize>,
        /// What is wrong, and what to write instead.
        why: String,
    },
    /// An override is wrong, alone or together with the preset.
    #[error("{overrides}: {why}")]
    Override {
        /// The overrides to blame, as they were given.
        overrides: String,
        /// What is wrong, and what to write instead.
        why: String,
    },
    /// Neither a built-in preset nor a file has this name.
    #[error(
        "no preset is called `{name}`{}; `conemarch presets` lists the built-in ones; a path of a .toml file, or of a .png or .exr file that this program wrote, is a preset too",
        perhaps(.nearest.iter().map(String::as_str))
    )]
    Unknown {
        /// What was asked for.
        name: String,
        /// Built-in presets with a similar name.
        nearest: Vec<String>,
    },
    /// The file could not be read, or is not what it should be.
    #[error("{path}: {why}")]
    File {
        /// Its path.
        path: String,
        /// What is wrong, and what to write instead.
        why: String,
    },
}

impl PresetError {
    /// Whether the command line is wrong, rather than a file.
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::Override { .. } | Self::Unknown { .. })
    }
}

/// `file:line`, or the file alone.
fn place(origin: &str, line: Option<usize>) -> String {
    match line {
        Some(line) => format!("{origin}:{line}"),
        None => origin.to_string(),
    }
}
