//! Finds a preset by its argument on the command line: a built-in name, the path of a TOML
//! file, or a picture that carries its preset.

use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use crate::preset::builtin::{BUILTIN, builtin};
use crate::preset::document::{Override, brief};
use crate::preset::error::PresetError;
use crate::preset::nearest::nearest;
use crate::preset::read::Preset;
use crate::raster::text_chunk::{self, SIGNATURE};

/// Largest preset that is read: far more than any preset needs, so that a wrong file is
/// rejected at once.
const MOST_BYTES: u64 = 1 << 20;

/// Keyword of the text chunk in which a PNG carries its preset.
pub const PNG_KEYWORD: &str = "conemarch preset";

/// Lines in the settings files of another renderer, which are no presets.
const MANDELBULBER: [&str; 2] = ["# Mandelbulber settings file", "[main_parameters]"];

const UNREADABLE: &str = "check its path and rights, or name a built-in preset";

/// The text of a preset before it is read.
#[derive(Clone, Debug)]
pub struct Source {
    /// The built-in name, or the name of the file without its extension.
    pub name: String,
    /// TOML.
    pub text: String,
    /// What errors call the preset.
    pub(super) origin: String,
    /// The folder that files named in the preset are relative to.
    pub(super) folder: PathBuf,
}

/// The file that an argument of [`load`] names; `None` for a built-in preset.
pub fn file(argument: &Path) -> Option<PathBuf> {
    named(argument).is_none().then(|| argument.into())
}

/// The text of the built-in preset that an argument names.
fn named(argument: &Path) -> Option<&'static str> {
    builtin(argument.to_str()?)
}

/// Finds and reads the preset that an argument names, with overrides.
///
/// # Errors
/// The name is unknown, the file cannot be read or carries no preset, or the preset or
/// an override is wrong.
pub fn load(argument: impl AsRef<Path>, overrides: &[Override]) -> Result<Preset, PresetError> {
    find(argument.as_ref())?.read(overrides)
}

/// Finds the text of the preset that an argument names.
///
/// # Errors
/// The name is unknown, or the file cannot be read or carries no preset.
pub fn find(argument: &Path) -> Result<Source, PresetError> {
    let shown = argument.to_string_lossy();
    if let Some(text) = named(argument) {
        return Ok(Source {
            name: shown.to_string(),
            text: text.into(),
            origin: format!("built-in preset {shown}"),
            folder: PathBuf::new(),
        });
    }
    let extension = argument.extension().and_then(|e| e.to_str()).unwrap_or("");
    let is_path = shown.contains(['/', '\\'])
        || ["toml", "png"].contains(&extension.to_lowercase().as_str())
        || (!shown.is_empty() && argument.exists());
    if !is_path {
        return Err(PresetError::Unknown {
            name: brief(&shown),
            nearest: similar(&shown),
        });
    }
    let text = file_text(argument).map_err(|why| PresetError::File {
        path: shown.to_string(),
        why,
    })?;
    let name = argument
        .file_stem()
        .map(|s| s.to_string_lossy().into_owned());
    Ok(Source {
        name: name.unwrap_or_else(|| "preset".into()),
        text,
        origin: shown.into_owned(),
        folder: argument.parent().unwrap_or(argument).into(),
    })
}

/// Built-in presets that may have been meant: the nearest, or those that share a part.
fn similar(name: &str) -> Vec<String> {
    let names = || BUILTIN.iter().map(|(n, _)| *n);
    if let Some(near) = nearest(name, names()) {
        return vec![near.to_string()];
    }
    let part = |n: &&str| name.len() >= 3 && (n.contains(name) || name.contains(n));
    names().filter(part).take(5).map(str::to_string).collect()
}

/// Whether a path is a stream of this process, as a shell's `<(command)` makes one.
fn is_own_stream(path: &Path) -> bool {
    path == Path::new("/dev/stdin") || path.starts_with("/dev/fd")
}

/// The text of the preset in a file, which may be a picture.
fn file_text(path: &Path) -> Result<String, String> {
    let unreadable = |e: std::io::Error| format!("cannot be read: {e}; {UNREADABLE}");
    let kind = fs::metadata(path).map_err(unreadable)?;
    if kind.is_dir() {
        return Err("is a folder; name a .toml or .png file in it".into());
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
    if bytes == SIGNATURE {
        let none = "carries no preset; only a PNG that this program wrote does";
        return text_chunk::text(&mut file, PNG_KEYWORD)?.ok_or_else(|| none.into());
    }
    let mut rest = file.take(MOST_BYTES + 1);
    rest.read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err("is larger than 1 MiB, which no preset is; is it the right file?".into());
    }
    let text = String::from_utf8(bytes).map_err(
        |_| "is not text in UTF-8; a preset is a TOML file, or a PNG that this program wrote",
    )?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let is_of = |line: &str| MANDELBULBER.contains(&line.trim());
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("fract") || text.lines().any(is_of) {
        return Err("is a settings file of Mandelbulber; only presets of conemarch are read, and `conemarch presets NAME` prints one to start from".into());
    }
    Ok(text.to_string())
}
