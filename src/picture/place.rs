//! Where a file will be: written under a temporary name beside it and renamed when
//! everything is there. A place that is dropped, or cleared by an interrupt, leaves
//! nothing behind.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::picture::error::OutputError;
use crate::picture::folder;

/// Names of all temporary files that exist now.
static TEMPORARY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn temporary() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of names cannot be half changed.
    TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file to be.
#[derive(Debug)]
pub struct Place {
    /// What the caller called it.
    shown: PathBuf,
    /// Where it will be: behind links, if the name is one.
    target: PathBuf,
    /// The temporary name; none for what cannot be renamed onto, like a pipe.
    held: Option<PathBuf>,
    file: File,
}

impl Place {
    /// Makes sure that a file can be written, by creating its temporary.
    ///
    /// # Errors
    /// The folder does not exist or cannot be written, or the name is a folder's or a
    /// write-protected file's.
    pub fn prepare(path: &Path) -> Result<Self, OutputError> {
        let shown = path.to_path_buf();
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        if let Ok(meta) = fs::metadata(&target) {
            if meta.is_dir() {
                let why = "is a folder; name a file in it";
                return Err(OutputError::file(path, why));
            }
            if meta.is_file() && meta.permissions().readonly() {
                let why = "is write-protected; choose another name";
                return Err(OutputError::file(path, why));
            }
            if !meta.is_file() {
                let opened = OpenOptions::new().write(true).open(&target);
                let file = opened.map_err(|e| OutputError::io(path, "cannot be written", &e))?;
                return Ok(Self {
                    shown,
                    target,
                    held: None,
                    file,
                });
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
        let name = format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id());
        let held = folder.join(name);
        // Locked while it comes to be, so that an interrupt misses none.
        let mut list = temporary();
        let made = OpenOptions::new().write(true).create_new(true).open(&held);
        let file = made.map_err(|e| {
            let doing = format!("cannot be written in the folder `{}`", folder.display());
            OutputError::io(path, &doing, &e)
        })?;
        list.push(held.clone());
        Ok(Self {
            shown,
            target,
            held: Some(held),
            file,
        })
    }

    /// Writes the content.
    ///
    /// # Errors
    /// The disk is full or `content` fails.
    pub fn write(
        &mut self,
        content: impl FnOnce(&mut BufWriter<&mut File>) -> Result<(), OutputError>,
    ) -> Result<(), OutputError> {
        let shown = self.shown.clone();
        let fail = |e: io::Error| OutputError::full(&shown, &e);
        if self.held.is_some() {
            self.file.set_len(0).map_err(fail)?;
            self.file.rewind().map_err(fail)?;
        }
        let mut to = BufWriter::new(&mut self.file);
        content(&mut to)?;
        to.flush().map_err(fail)
    }

    /// Writes bytes as the content.
    ///
    /// # Errors
    /// The disk is full.
    pub fn write_all(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        let shown = self.shown.clone();
        let fail = |e: io::Error| OutputError::full(&shown, &e);
        self.write(|to| to.write_all(bytes).map_err(fail))
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        if let Some(held) = self.held.take() {
            let mut list = temporary();
            // Nothing better can be done about a file that does not go.
            let _ = fs::remove_file(&held);
            list.retain(|p| *p != held);
        }
    }
}

/// Gives written files their names, all of them or none as far as that can be.
///
/// # Errors
/// A rename fails; files not renamed yet are removed.
pub fn commit(places: Vec<Place>) -> Result<(), OutputError> {
    let mut list = temporary();
    let mut failed = None;
    for mut place in places {
        if let (None, Some(held)) = (&failed, &place.held) {
            match fs::rename(held, &place.target) {
                Ok(()) => {
                    list.retain(|p| p != held);
                    place.held = None;
                }
                Err(e) => failed = Some(OutputError::io(&place.shown, "cannot be renamed", &e)),
            }
        }
        if let Some(held) = place.held.take() {
            let _ = fs::remove_file(&held);
            list.retain(|p| *p != held);
        }
    }
    failed.map_or(Ok(()), Err)
}

/// Removes all temporary files, and folders that were made for them and are empty then,
/// and lets no more be renamed: for the moment before the process ends. The guard must be kept until then.
pub fn clear() -> MutexGuard<'static, Vec<PathBuf>> {
    let mut list = temporary();
    for held in list.drain(..) {
        let _ = fs::remove_file(held);
    }
    folder::clear();
    list
}
