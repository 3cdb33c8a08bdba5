//! Why a kernel cannot be.

use thiserror::Error;

use crate::base::shader::ShaderError;

/// Why a kernel could not be compiled or bound.
#[derive(Debug, Error)]
pub enum KernelError {
    /// The program is invalid.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// The driver refused the pipeline.
    #[error("{path}:{line}: the device `{device}` refused the program `{entry}`: {why}")]
    Refused {
        /// The file of the entry point.
        path: &'static str,
        /// Its line, from 1.
        line: usize,
        /// Its name.
        device: String,
        /// The program.
        entry: &'static str,
        /// The driver's reason.
        why: String,
    },
    /// A variable of the program has no buffer.
    #[error("{path}:{line}: the program `{entry}` needs a buffer for `{name}`, and there is none")]
    Unbound {
        /// The file that declares the variable.
        path: &'static str,
        /// Its line, from 1.
        line: usize,
        /// The program.
        entry: &'static str,
        /// The variable.
        name: String,
    },
    /// A variable of the program is larger than its buffer.
    #[error(
        "{path}:{line}: the program `{entry}` needs {needed} bytes for `{name}`, and there are {bytes}; the fields of a struct are those of its Rust twin"
    )]
    Small {
        /// The file that declares the variable.
        path: &'static str,
        /// Its line, from 1.
        line: usize,
        /// The program.
        entry: &'static str,
        /// The variable.
        name: String,
        /// Its size in bytes, with one element of an array of any length.
        needed: u64,
        /// The size of the buffer.
        bytes: u64,
    },
}

impl KernelError {
    /// The entry point of the program.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::Shader(ShaderError::Text { entry, .. })
            | Self::Refused { entry, .. }
            | Self::Unbound { entry, .. }
            | Self::Small { entry, .. } => entry,
        }
    }
}
