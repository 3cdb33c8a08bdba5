//! Why heights or a cone map cannot be read, written or used: one sentence that says where, what,
//! and how to go on.

use std::path::Path;

use thiserror::Error;

/// What can be wrong with a file of heights or cones, or with what was asked for.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FileError {
    /// The file cannot be read, is not what it should be, or does not fit this use.
    #[error("{path}: {why}")]
    File {
        /// Its path.
        path: String,
        /// What is wrong and how to go on.
        why: String,
    },
    /// The command line is wrong: a name, or a layout that cannot hold the map.
    #[error("{0}")]
    Usage(String),
}

impl FileError {
    pub(crate) fn file(path: &Path, why: impl Into<String>) -> Self {
        Self::File {
            path: path.display().to_string(),
            why: why.into(),
        }
    }

    /// Whether the command line is wrong, rather than a file.
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::Usage(_))
    }
}
