//! Why there is no height map: one sentence that says where, what, and what would do.

use std::path::Path;

use thiserror::Error;

/// What can be wrong with the argument that names heights, or with what it names.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LoadError {
    /// The file could not be read, or is not what it should be.
    #[error("{path}: {why}")]
    File {
        /// Its path.
        path: String,
        /// What is wrong and what would do.
        why: String,
    },
    /// The argument names neither a file nor a field.
    #[error("{argument}: {why}")]
    Argument {
        /// What was given.
        argument: String,
        /// What is wrong and what would do.
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
        // A long text is no name, and nobody reads it twice.
        let argument = argument.chars().take(80).collect();
        let why = why.into();
        Self::Argument { argument, why }
    }

    /// Whether the command line is wrong, rather than a file.
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::Argument { .. })
    }
}
