//! Files that appear whole or not at all: each is written under a temporary name in its own
//! folder and renamed at the end. A [`Place`] that is dropped leaves nothing behind, and
//! [`clear`] takes away what is left when an interrupt ends the process.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::TempPath;

use crate::picture::error::OutputError;

/// All temporary files and folders that were made, each after the folders that it is in. Names of
/// files are never used twice, so one that is gone may stay in the list.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

pub(super) fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of names cannot be half changed.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file that will appear.
#[derive(Debug)]
pub struct Place {
    /// What the caller called it.
    shown: PathBuf,
    /// Where it will be: behind links, if the name is one.
    target: PathBuf,
    /// The temporary name; `None` for what cannot be replaced, like a pipe.
    held: Option<TempPath>,
    file: File,
}

impl Place {
    /// Makes sure that a file can be written, by creating its temporary file.
    ///
    /// # Errors
    /// The folder does not exist or cannot be written, or the name is that of a folder or of
    /// a write-protected file.
    pub fn prepare(path: &Path) -> Result<Self, OutputError> {
        let place = |target, held, file| Self {
            shown: path.to_path_buf(),
            target,
            held,
            file,
        };
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        if let Ok(meta) = fs::metadata(&target) {
            if meta.is_dir() {
                return Err(OutputError::file(path, "is a folder; name a file in it"));
            }
            if meta.is_file() && meta.permissions().readonly() {
                let why = "is write-protected; choose another name";
                return Err(OutputError::file(path, why));
            }
            if !meta.is_file() {
                let opened = OpenOptions::new().write(true).open(&target);
                let file = opened.map_err(|e| OutputError::io(path, "cannot be written", &e))?;
                return Ok(place(target, None, file));
            }
        }
        let Some(name) = target.file_name() else {
            return Err(OutputError::file(path, "is no file name"));
        };
        let folder = match target.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        if !folder.is_dir() {
            let why = format!("there is no folder `{}`; make it first", folder.display());
            return Err(OutputError::file(path, why));
        }
        // Locked while the file is made, so that an interrupt misses none.
        let mut list = unfinished();
        let made = builder(&format!(".{}.", name.to_string_lossy()), ".tmp").tempfile_in(folder);
        let (file, held) = made.map(tempfile::NamedTempFile::into_parts).map_err(|e| {
            // The error itself names the temporary file.
            let why = format!(
                "cannot be written: {}; check the rights of the folder `{}`, or name another",
                e.kind(),
                folder.display()
            );
            OutputError::file(path, why)
        })?;
        list.push(held.to_path_buf());
        Ok(place(target.clone(), Some(held), file))
    }

    /// Whether the file appears at the end. What cannot be replaced, like a pipe, does not.
    pub fn appears(&self) -> bool {
        self.held.is_some()
    }

    /// Writes the content.
    ///
    /// # Errors
    /// The disk is full or `content` fails.
    pub fn write<E: From<OutputError>>(
        &mut self,
        content: impl FnOnce(&mut BufWriter<ErrorKeepingFile<'_>>) -> Result<(), E>,
    ) -> Result<(), E> {
        let shown = self.shown.clone();
        let fail = |e: io::Error| OutputError::full(&shown, &e);
        if self.held.is_some() {
            self.file.set_len(0).map_err(fail)?;
            self.file.rewind().map_err(fail)?;
        }
        let mut to = BufWriter::new(ErrorKeepingFile {
            file: &mut self.file,
            fault: None,
        });
        let written = content(&mut to).and_then(|()| to.flush().map_err(|e| fail(e).into()));
        // An encoder does not say which file is full.
        match to.into_parts().0.fault {
            Some(fault) if written.is_err() => Err(fail(fault).into()),
            _ => written,
        }
    }

    /// Writes bytes as the content.
    ///
    /// # Errors
    /// The disk is full.
    pub fn write_all(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        let shown = self.shown.clone();
        self.write(|to| {
            to.write_all(bytes)
                .map_err(|e| OutputError::full(&shown, &e))
        })
    }
}

/// A file that remembers why it could not be written.
#[derive(Debug)]
pub struct ErrorKeepingFile<'a> {
    file: &'a mut File,
    fault: Option<io::Error>,
}

impl Write for ErrorKeepingFile<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes).inspect_err(|e| {
            // One that can be tried again is none.
            if e.kind() != io::ErrorKind::Interrupted {
                let same = e.raw_os_error().map(io::Error::from_raw_os_error);
                self.fault = Some(same.unwrap_or_else(|| e.kind().into()));
            }
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for ErrorKeepingFile<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Makes temporary files with the rights of any new file: those of `tempfile` are for their
/// owner alone.
fn builder<'a>(prefix: &'a str, suffix: &'a str) -> tempfile::Builder<'a, 'a> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix).suffix(suffix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder
}

/// Writes content to a new file in the folder of temporary files, which stays. Returns its path.
///
/// # Errors
/// That folder is full too, or is not there.
pub fn keep(content: &[u8], ending: &str) -> io::Result<PathBuf> {
    let mut file = builder("conemarch-", &format!(".{ending}")).tempfile()?;
    file.write_all(content)?;
    Ok(file.keep()?.1)
}

/// Gives written files their names. If one of them cannot be renamed, the files after it are
/// removed.
///
/// # Errors
/// A rename fails.
pub fn commit(places: Vec<Place>) -> Result<(), OutputError> {
    let _no_interrupt = unfinished();
    for place in places {
        if let Some(held) = place.held {
            drop(place.file);
            let renamed = held.persist(&place.target);
            renamed.map_err(|e| OutputError::io(&place.shown, "cannot be renamed", &e.error))?;
        }
    }
    Ok(())
}

/// Says whether a file is a temporary one, which an interrupt takes away.
pub fn set_unfinished(path: &Path, is_unfinished: bool) {
    let mut list = unfinished();
    list.retain(|other| other != path);
    if is_unfinished {
        list.push(path.into());
    }
}

/// Removes all temporary files, and folders that were made for them and are empty then.
/// Called at the end of an interrupted process: nothing is renamed while the guard lives.
pub fn clear() -> MutexGuard<'static, Vec<PathBuf>> {
    let mut list = unfinished();
    for path in list.drain(..).rev() {
        // A folder that holds anything stays: the system removes only empty ones.
        let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir(path));
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_file_has_the_rights_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let [new, usual] = ["new", "usual"].map(|name| folder.path().join(name));
        let mut place = Place::prepare(&new).expect("can be written");
        place.write_all(b"content").expect("can be written");
        commit(vec![place]).expect("can be renamed");
        fs::write(&usual, b"content").expect("can be written");
        let [new, usual] = [new, usual].map(|p| fs::metadata(p).expect("written above"));
        assert_eq!(new.permissions().mode(), usual.permissions().mode());
    }
}
