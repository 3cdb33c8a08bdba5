//! Cone maps on their way out: encoded in memory, then written whole or not at all.

use std::path::Path;

use crate::heightfield::conemap::file::{MapError, MapFile, MapFormat, encode};
use crate::picture::error::OutputError;
use crate::picture::place::{Place, commit};
use thiserror::Error;

/// Why a cone map could not be written.
#[derive(Debug, Error)]
pub enum WriteMapError {
    /// It has no place in the layout.
    #[error(transparent)]
    Map(#[from] MapError),
    /// The file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Writes a map in a format. The file appears under its name when all of it is there.
///
/// # Errors
/// The layout cannot hold the map, or the file cannot be written.
pub fn write_map(path: &Path, file: &MapFile, format: &MapFormat) -> Result<(), WriteMapError> {
    let bytes = encode(file, format)?;
    let mut place = Place::prepare(path)?;
    place.write_all(&bytes)?;
    commit(vec![place])?;
    Ok(())
}
