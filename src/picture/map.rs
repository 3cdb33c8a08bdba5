//! Writes cone maps, whole or not at all.

use std::path::Path;

use crate::heightfield::conemap::file::{Form, MapError, MapFile, encode};
use crate::picture::error::OutputError;
use crate::picture::place::{Place, commit};
use thiserror::Error;

/// Why a cone map could not be written.
#[derive(Debug, Error)]
pub enum WriteMapError {
    /// The layout cannot hold it.
    #[error(transparent)]
    Map(#[from] MapError),
    /// The file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Writes a map in a form. The file appears under its name when it is complete.
///
/// # Errors
/// The layout cannot hold the map, or the file cannot be written.
pub fn write_map(path: &Path, file: &MapFile, form: &Form) -> Result<(), WriteMapError> {
    let bytes = encode(file, form)?;
    let mut place = Place::prepare(path)?;
    place.write_all(&bytes)?;
    commit(vec![place])?;
    Ok(())
}
