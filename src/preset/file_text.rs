//! The text of a preset in a TOML file, or in a picture that carries it.

use std::fs::{self, File};
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use crate::preset::PNG_KEYWORD;
use crate::raster::exr;
use crate::raster::text_chunk::{self, MOST_TEXT, SIGNATURE};

/// The first bytes of an EXR.
const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Lines in the settings files of another renderer, which are no presets.
const MANDELBULBER: [&str; 2] = ["# Mandelbulber settings file", "[main_parameters]"];

const UNREADABLE: &str = "check its path and rights, or name a built-in preset";

/// Whether a path is a stream of this process, as a shell's `<(command)` makes one.
fn is_own_stream(path: &Path) -> bool {
    path == Path::new("/dev/stdin") || path.starts_with("/dev/fd")
}

/// The text of the preset in a file, which may be a picture.
pub fn file_text(path: &Path) -> Result<String, String> {
    let unreadable = |e: std::io::Error| format!("cannot be read: {e}; {UNREADABLE}");
    let kind = fs::metadata(path).map_err(unreadable)?;
    if kind.is_dir() {
        return Err("is a folder; name a .toml, .png or .exr file in it".into());
    }
    // Asked before the file is opened: opening a pipe waits until somebody writes into it,
    // and a device may never end. Streams of this process are open already.
    if !kind.is_file() && !is_own_stream(path) {
        return Err("is no regular file but a pipe, a socket or a device; name a .toml or .png file, or send the preset to /dev/stdin".into());
    }
    let mut file = BufReader::new(File::open(path).map_err(unreadable)?);
    let mut bytes = Vec::new();
    let mut start = file.by_ref().take(SIGNATURE.len() as u64);
    start.read_to_end(&mut bytes).map_err(unreadable)?;
    let none = "carries no preset; only a PNG or EXR that this program wrote does";
    if bytes.starts_with(&EXR) {
        file.rewind().map_err(unreadable)?;
        return exr::text(file, PNG_KEYWORD)?.ok_or_else(|| none.into());
    }
    if bytes == SIGNATURE {
        return text_chunk::text(&mut file, PNG_KEYWORD)?.ok_or_else(|| none.into());
    }
    let mut rest = file.take(MOST_TEXT as u64 + 1);
    rest.read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() > MOST_TEXT {
        return Err("is larger than 1 MiB, which no preset is; is it the right file?".into());
    }
    let text = String::from_utf8(bytes).map_err(
        |_| "is not text in UTF-8; a preset is a TOML file, or a PNG or EXR that this program wrote",
    )?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let is_of = |line: &str| MANDELBULBER.contains(&line.trim());
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("fract") || text.lines().any(is_of) {
        return Err("is a settings file of Mandelbulber; only presets of conemarch are read, and `conemarch presets NAME` prints one to start from".into());
    }
    Ok(text.to_string())
}
