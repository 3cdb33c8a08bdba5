//! Why a picture could not be written.

#[cfg(feature = "cli")]
use std::io;
#[cfg(feature = "cli")]
use std::path::Path;
use std::path::PathBuf;

use thiserror::Error;

/// What can go wrong between a frame and a file.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The file cannot be made or written.
    #[error("{}: {why}", .path.display())]
    File {
        /// Its path.
        path: PathBuf,
        /// What is wrong, and what to do instead.
        why: String,
        /// Whether the disk is full.
        is_full: bool,
    },
    /// The picture could not be encoded.
    #[error("the picture could not be encoded as {format}: {why}")]
    Encode {
        /// `PNG`, `JPEG`, `WebP` or `EXR`.
        format: &'static str,
        /// What the encoder said.
        why: String,
    },
}

impl OutputError {
    /// What an encoder said.
    pub(crate) fn encode(format: &'static str, e: impl std::fmt::Display) -> Self {
        let why = e.to_string();
        Self::Encode { format, why }
    }
}

/// Whether an error means that nothing more can be stored.
#[cfg(feature = "cli")]
pub fn is_full(kind: io::ErrorKind) -> bool {
    use io::ErrorKind::{QuotaExceeded, StorageFull};
    matches!(kind, StorageFull | QuotaExceeded)
}

/// Failures of files.
#[cfg(feature = "cli")]
impl OutputError {
    pub(crate) fn file(path: &Path, why: impl Into<String>) -> Self {
        Self::File {
            path: path.to_path_buf(),
            why: why.into(),
            is_full: false,
        }
    }

    /// A failure while content is written: a full disk, mostly.
    pub(crate) fn full(path: &Path, e: &io::Error) -> Self {
        let would = "free some space, or name a file elsewhere";
        Self::File {
            path: path.to_path_buf(),
            why: format!("cannot be written: {e}; {would}"),
            is_full: is_full(e.kind()),
        }
    }

    /// A failure of the file system while doing something.
    pub(crate) fn io(path: &Path, doing: &str, e: &io::Error) -> Self {
        Self::file(path, format!("{doing}: {e}"))
    }
}
