//! Where results go: a file, or standard output under the name `-`.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{fs, io};

use anyhow::{Context, Result, anyhow};
use serde::Serialize;

use crate::command::failure::usage;
use crate::command::print::deliver;
use crate::picture::{OutputError, Place, commit, is_full, keep};

/// Where one result goes.
#[derive(Debug)]
pub enum Sink {
    /// Standard output.
    Stdout,
    /// A file that can be written.
    File(Place),
}

impl Sink {
    /// Makes sure that a result can be written.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn prepare(path: &Path) -> Result<Self, OutputError> {
        Ok(match is_stdout(path) {
            true => Self::Stdout,
            false => Self::File(Place::prepare(path)?),
        })
    }

    /// Writes the one result of a command.
    ///
    /// # Errors
    /// The disk is full, or standard output does not take all of it.
    pub fn finish(self, content: &[u8]) -> Result<()> {
        let mut results = Results::default();
        results.put(self, content)?;
        results.hand_over()
    }
}

/// Whether a name means standard output.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Refuses outputs of one command that would overwrite each other. Each comes with its option;
/// `None` stands for an option that was not given.
///
/// # Errors
/// Two options name the same file.
pub fn apart(outputs: &[(&str, Option<&Path>)]) -> Result<()> {
    let mut seen: Vec<(&str, PathBuf)> = Vec::new();
    for (option, path) in outputs {
        let Some(path) = path else { continue };
        let file = file_of(path);
        if let Some((other, _)) = seen.iter().find(|(_, f)| *f == file) {
            return Err(usage(format!(
                "{other} and {option} cannot both go to `{}`; give {option} another name",
                path.display()
            )));
        }
        seen.push((option, file));
    }
    Ok(())
}

/// Refuses outputs that would overwrite what the command reads. Each comes with its option,
/// and each input with what it is.
///
/// # Errors
/// An output is one of the inputs, perhaps by another name.
pub fn spared(outputs: &[(&str, Option<&Path>)], inputs: &[(&str, PathBuf)]) -> Result<()> {
    for (option, path) in outputs {
        let Some(path) = path.filter(|path| !is_stdout(path)) else {
            continue;
        };
        let file = file_of(path);
        let taken = inputs.iter().find(|(_, input)| file_of(input) == file);
        if let Some((what, _)) = taken {
            return Err(usage(format!(
                "{option} would overwrite {what}, `{}`; give it another name with -o or its option",
                path.display()
            )));
        }
    }
    Ok(())
}

/// The ending of a name, in small letters.
pub fn ending(path: &Path) -> String {
    let ending = path.extension().and_then(|e| e.to_str());
    ending.unwrap_or_default().to_lowercase()
}

/// Keeps a picture that met a full disk in the folder of temporary files, and tells where.
pub fn rescued(fault: anyhow::Error, picture: &[u8], output: &Path) -> anyhow::Error {
    let was_full = |e: &(dyn Error + 'static)| match (e.downcast_ref(), e.downcast_ref()) {
        (Some(OutputError::File { is_full, .. }), _) => *is_full,
        (_, Some(e)) => is_full(io::Error::kind(e)),
        _ => false,
    };
    if !fault.chain().any(was_full) {
        return fault;
    }
    let ending = match is_stdout(output) {
        true => "png".into(),
        false => ending(output),
    };
    match keep(picture, &ending) {
        Ok(kept) => anyhow!("{fault:#}; the picture is in `{}`", kept.display()),
        Err(e) => anyhow!(
            "{fault:#}; the folder of temporary files does not take the picture either: {e}"
        ),
    }
}

/// A name in messages.
pub fn shown(path: &Path) -> String {
    match is_stdout(path) {
        true => "standard output".into(),
        false => path.display().to_string(),
    }
}

/// The folder of a file.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// The file behind a name, with links and `..` resolved. It need not exist.
fn file_of(path: &Path) -> PathBuf {
    if is_stdout(path) {
        return path.into();
    }
    let folder = folder_of(path);
    let new = || Some(fs::canonicalize(folder).ok()?.join(path.file_name()?));
    let there = fs::canonicalize(path).ok();
    there.or_else(new).unwrap_or_else(|| path.into())
}

/// The results of a command, which are handed over together at its end.
#[derive(Debug, Default)]
pub struct Results {
    printed: Vec<u8>,
    places: Vec<Place>,
}

impl Results {
    /// Adds a result.
    ///
    /// # Errors
    /// The disk is full.
    pub fn put(&mut self, sink: Sink, content: &[u8]) -> Result<(), OutputError> {
        match sink {
            Sink::Stdout => self.printed.extend(content),
            Sink::File(mut place) => {
                place.write_all(content)?;
                self.add(place);
            }
        }
        Ok(())
    }

    /// Adds a result as JSON.
    ///
    /// # Errors
    /// The disk is full.
    pub fn put_json(&mut self, sink: Sink, content: &(impl Serialize + ?Sized)) -> Result<()> {
        let mut text = serde_json::to_vec_pretty(content).context("JSON cannot be written")?;
        text.push(b'\n');
        Ok(self.put(sink, &text)?)
    }

    /// Adds what goes to standard output.
    pub fn print(&mut self, content: &[u8]) {
        self.printed.extend(content);
    }

    /// Adds a file that is written already.
    pub fn add(&mut self, place: Place) {
        self.places.push(place);
    }

    /// Prints what goes to standard output, and then gives all files their names.
    ///
    /// # Errors
    /// Standard output does not take all of it, or a file cannot be renamed.
    pub fn hand_over(self) -> Result<()> {
        if !self.printed.is_empty() {
            deliver(&self.printed)?;
        }
        commit(self.places)?;
        Ok(())
    }
}
