//! Why heights cannot be loaded: one sentence that says where, what, and how to go on.

use std::path::Path;

use thiserror::Error;

/// What can be wrong with the argument that names heights, or with the file.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LoadError {
    /// The file could not be read, or is not what it should be.
    #[error("{path}: {why}")]
    File {
        /// Its path.
        path: String,
        /// What is wrong and how to go on.
        why: String,
    },
    /// The argument names neither a file nor a pattern.
    #[error("{argument}: {why}")]
    Argument {
        /// What was given.
        argument: String,
        /// What is wrong and how to go on.
        why: String,
    },
}

impl LoadError {
    pub(crate) fn file(path: &Path, why: impl Into<String>) -> Self {
        Self::File {
            path: path.display().to_string(),
            why: why.into(),
        }
    }

    pub(crate) fn argument(argument: &str, why: impl Into<String>) -> Self {
        // A long text is not a name, and need not be repeated in full.
        let argument = argument.chars().take(80).collect();
        let why = why.into();
        Self::Argument { argument, why }
    }

    /// Whether the command line is wrong, rather than a file.
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::Argument { .. })
    }
}
