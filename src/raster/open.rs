//! Opens a file and recognises its format by its first bytes, whatever its name says.
//!
//! Pipes and devices are refused: the readers must seek, and a pipe without a writer
//! would wait for ever.

#[cfg(feature = "cli")]
use std::fs::{self, File};
#[cfg(feature = "cli")]
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use crate::raster::text_chunk::SIGNATURE;

/// What the first bytes of a file tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Portable Network Graphics.
    Png,
    /// OpenEXR.
    Exr,
    /// TIFF, or BigTIFF.
    Tiff,
    /// JPEG, which is recognised only to say why it is refused.
    Jpeg,
    /// Any other format; raw numbers have no mark.
    Other,
}

/// What is read.
#[cfg(feature = "cli")]
pub type Stream = BufReader<File>;
/// What is read where there are no files.
#[cfg(not(feature = "cli"))]
pub type Stream = std::io::Cursor<Vec<u8>>;

/// An open file at its start.
#[derive(Debug)]
pub struct Opened {
    /// The file.
    pub file: Stream,
    /// Its length in bytes.
    pub bytes: u64,
    /// Its format.
    pub format: Format,
}

/// First bytes and the formats that they belong to.
const MARKS: [(&[u8], Format); 7] = [
    (SIGNATURE, Format::Png),
    (b"\x76\x2f\x31\x01", Format::Exr),
    (b"II*\0", Format::Tiff),
    (b"MM\0*", Format::Tiff),
    (b"II+\0", Format::Tiff),
    (b"MM\0+", Format::Tiff),
    (b"\xff\xd8\xff", Format::Jpeg),
];

/// Opens a file for reading.
///
/// # Errors
/// In words, without the file's name: it is not there, may not be read, is a folder, a
/// pipe or a device, or is empty.
#[cfg(feature = "cli")]
pub fn open(path: &Path) -> Result<Opened, String> {
    let unreadable =
        |e: std::io::Error| format!("cannot be read: {e}; check its path and its rights");
    let known = fs::metadata(path).map_err(unreadable)?;
    if known.is_dir() {
        return Err("is a folder; name a file in it".into());
    }
    if !known.is_file() {
        return Err("is a pipe or a device; save its content to a file first".into());
    }
    if known.len() == 0 {
        return Err("is empty; was it written to its end?".into());
    }
    let mut file = BufReader::new(File::open(path).map_err(unreadable)?);
    let mut start = Vec::new();
    let mut first = (&mut file).take(8);
    first.read_to_end(&mut start).map_err(unreadable)?;
    file.rewind().map_err(unreadable)?;
    Ok(Opened {
        file,
        bytes: known.len(),
        format: format_of(&start),
    })
}

/// Refuses to open a file where there are none.
///
/// # Errors
/// Always.
#[cfg(not(feature = "cli"))]
pub fn open(_: &Path) -> Result<Opened, String> {
    Err("cannot be read: this program was built without files".into())
}

/// What the first bytes of a file tell.
pub fn format_of(start: &[u8]) -> Format {
    let found = MARKS.iter().find(|(mark, _)| start.starts_with(mark));
    found.map_or(Format::Other, |(_, format)| *format)
}

/// Longest side of what is read.
pub const MOST_SIDE: u32 = 8192;

/// A size that may be read.
///
/// # Errors
/// In words: an axis has no samples or too many. This is checked before memory is allocated
/// for what a header claims.
pub fn check_size(width: u64, height: u64) -> Result<[u32; 2], String> {
    let sane = |n: &u32| (1..=MOST_SIDE).contains(n);
    let side = |n: u64| u32::try_from(n).ok().filter(sane);
    match (side(width), side(height)) {
        (Some(w), Some(h)) => Ok([w, h]),
        _ => Err(format!(
            "is {width} x {height}, and each axis may have 1 to {MOST_SIDE}; cut or scale it"
        )),
    }
}
