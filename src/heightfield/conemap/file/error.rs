//! Why a cone map cannot be read, written or used: one sentence that says where, what,
//! and how to go on.

use std::path::Path;

use thiserror::Error;

/// What can be wrong with a map and its file.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MapError {
    /// The file could not be read, or is not what it should be.
    #[error("{path}: {why}")]
    File {
        /// Its path.
        path: String,
        /// What is wrong and how to go on.
        why: String,
    },
    /// The layout cannot hold the map.
    #[error("the layout `{layout}` {why}")]
    Layout {
        /// Its name.
        layout: &'static str,
        /// What is wrong and how to go on.
        why: String,
    },
    /// The map is valid, but not for this use.
    #[error("{path}: {why}")]
    Misfit {
        /// Its path.
        path: String,
        /// What does not match and how to go on.
        why: String,
    },
}

impl MapError {
    pub(crate) fn file(path: &Path, why: impl Into<String>) -> Self {
        Self::File {
            path: path.display().to_string(),
            why: why.into(),
        }
    }

    /// What is wrong and how to go on, without the file.
    pub fn into_why(self) -> String {
        match self {
            Self::File { why, .. } | Self::Layout { why, .. } | Self::Misfit { why, .. } => why,
        }
    }

    /// Whether the command line is wrong, rather than a file.
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::Layout { .. })
    }
}
