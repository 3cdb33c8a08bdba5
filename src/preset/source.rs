//! Finds a preset by its argument on the command line: a built-in name, the path of a TOML
//! file, or a picture that carries its preset.

use std::path::{Path, PathBuf};

use crate::preset::builtin::{BUILTIN, builtin};
use crate::preset::document::{Override, brief};
use crate::preset::error::PresetError;
#[cfg(feature = "cli")]
use crate::preset::file_text::file_text;
use crate::preset::nearest::nearest;
use crate::preset::read::Preset;

/// Keyword of the text chunk in which a PNG carries its preset.
pub const PNG_KEYWORD: &str = "conemarch preset";

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
    let is_path = shown.contains(['/', '\\', '.'])
        || (cfg!(feature = "cli") && !shown.is_empty() && argument.exists());
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

#[cfg(not(feature = "cli"))]
fn file_text(_: &Path) -> Result<String, String> {
    Err("cannot be read: this program was built without files".into())
}
