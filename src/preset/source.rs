//! Finding a preset by what the command line calls it: a built-in name, the path of a
//! TOML file, or a picture that carries its preset.

use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use crate::plan::Plan;
use crate::preset::builtin::{BUILTIN, builtin};
use crate::preset::document::{Override, brief};
use crate::preset::error::PresetError;
use crate::preset::nearest::nearest;
use crate::preset::read::{Reading, read_in};
use crate::scene::Assets;

/// Largest preset that is read: far more than any preset needs, and little enough to
/// refuse a wrong file at once.
pub const MOST_BYTES: u64 = 1 << 20;

/// Keyword of the text chunk in which a picture carries its preset.
pub const PNG_KEYWORD: &str = "conemarch preset";

/// The first bytes of every PNG file.
const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// A preset that was found and read.
#[derive(Clone, Debug)]
pub struct Preset {
    /// The built-in name, or the file's without its ending.
    pub name: String,
    /// The plan.
    pub plan: Plan,
    reading: Reading,
}

impl Preset {
    fn of(name: String, reading: Reading) -> Self {
        Self {
            name,
            plan: reading.plan.clone(),
            reading,
        }
    }

    /// Reads the files that the preset names, and keeps them in the assets.
    ///
    /// # Errors
    /// A file cannot be read, holds something else or does not fit. The error names the line
    /// of the preset, or the override.
    pub fn load_assets(&self, assets: &Assets) -> Result<(), PresetError> {
        let loaded = self.reading.plan.scene.load(assets);
        loaded.map_err(|fault| self.reading.blame(fault))
    }
}

/// The file that an argument of [`load`] names; none for a built-in preset.
pub fn file(argument: &str) -> Option<PathBuf> {
    builtin(argument).is_none().then(|| argument.into())
}

/// Finds and reads what an argument means, with overrides.
///
/// # Errors
/// The name is unknown, the file cannot be read or carries no preset, or the preset or
/// an override is wrong.
pub fn load(argument: &str, overrides: &[Override]) -> Result<Preset, PresetError> {
    if let Some(text) = builtin(argument) {
        let origin = format!("built-in preset {argument}");
        let reading = read_in(Path::new(""), text, &origin, overrides)?;
        return Ok(Preset::of(argument.into(), reading));
    }
    let path = Path::new(argument);
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let is_path = argument.contains(['/', '\\'])
        || ["toml", "png"].contains(&ending.to_lowercase().as_str())
        || (!argument.is_empty() && path.exists());
    if !is_path {
        return Err(PresetError::Unknown {
            name: brief(argument),
            nearest: similar(argument),
        });
    }
    let text = file_text(path)?;
    let name = path.file_stem().map(|s| s.to_string_lossy().into_owned());
    let reading = read_in(path.parent().unwrap_or(path), &text, argument, overrides)?;
    Ok(Preset::of(name.unwrap_or_else(|| "preset".into()), reading))
}

/// Built-in presets that may have been meant: the nearest, or those that begin alike.
fn similar(name: &str) -> Vec<String> {
    let names = || BUILTIN.iter().map(|(n, _)| *n);
    if let Some(near) = nearest(name, names()) {
        return vec![near.to_string()];
    }
    let part = |n: &&str| name.len() >= 3 && (n.contains(name) || name.contains(n));
    names().filter(part).take(5).map(str::to_string).collect()
}

fn failure(path: &Path, why: impl Into<String>) -> PresetError {
    PresetError::File {
        path: path.display().to_string(),
        why: why.into(),
    }
}

/// Whether a name means a stream of this process, as a shell's `<(command)` does.
fn is_own_stream(path: &Path) -> bool {
    path == Path::new("/dev/stdin") || path.starts_with("/dev/fd")
}

/// The preset's text in a file, be it the file itself or a picture's.
fn file_text(path: &Path) -> Result<String, PresetError> {
    let unreadable = |e: std::io::Error| {
        failure(
            path,
            format!("cannot be read: {e}; check its path and rights, or name a built-in preset"),
        )
    };
    let what = fs::metadata(path).map_err(unreadable)?;
    if what.is_dir() {
        return Err(failure(
            path,
            "is a folder; name a .toml or .png file in it",
        ));
    }
    // Asked before it is opened: opening a pipe waits for somebody to write into it, and a
    // device may never end. Streams that this process was given are open already.
    if !what.is_file() && !is_own_stream(path) {
        return Err(failure(
            path,
            "is no regular file but a pipe, a socket or a device; name a .toml or .png file, or send the preset to /dev/stdin",
        ));
    }
    let mut file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    let mut start = (&mut file).take(PNG_SIGNATURE.len() as u64);
    start.read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes == PNG_SIGNATURE {
        return picture_text(path, std::io::Cursor::new(bytes).chain(file));
    }
    let mut rest = file.take(MOST_BYTES + 1);
    rest.read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(failure(
            path,
            "is larger than 1 MiB, which no preset is; is it the right file?",
        ));
    }
    let text = String::from_utf8(bytes).map_err(|_| {
        failure(
            path,
            "is not text in UTF-8; a preset is a TOML file, or a PNG that this program wrote",
        )
    })?;
    Ok(text
        .strip_prefix('\u{feff}')
        .map_or(text.clone(), str::to_string))
}

/// The preset in a picture's text chunks.
fn picture_text(path: &Path, picture: impl Read) -> Result<String, PresetError> {
    // The decoder wants to seek; text chunks stand before the pixels, so the head
    // of the file is enough. What it lacks then shows as a broken picture.
    let mut head = Vec::new();
    let mut part = BufReader::new(picture).take(4 * MOST_BYTES);
    part.read_to_end(&mut head).map_err(|e| {
        failure(
            path,
            format!("cannot be read: {e}; check its path and rights, or name a built-in preset"),
        )
    })?;
    let reader = png::Decoder::new(std::io::Cursor::new(head))
        .read_info()
        .map_err(|e| {
            failure(
                path,
                format!("is a broken PNG: {e}; render it again from its preset"),
            )
        })?;
    let chunks = &reader.info().utf8_text;
    let chunk = chunks.iter().find(|c| c.keyword == PNG_KEYWORD);
    let Some(chunk) = chunk else {
        return Err(failure(
            path,
            "carries no preset; only a PNG that this program wrote does",
        ));
    };
    // Another program may have saved the chunk compressed.
    let mut chunk = chunk.clone();
    chunk
        .decompress_text_with_limit(MOST_BYTES as usize)
        .and_then(|()| chunk.get_text())
        .map_err(|e| failure(path, format!("carries a preset that cannot be read: {e}")))
}
