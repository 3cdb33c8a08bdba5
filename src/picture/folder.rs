//! A folder for results. It is made if it is missing, and removed again if it stays empty
//! because of an error or an interrupt.

use std::fs;
use std::path::{Path, PathBuf};

use crate::picture::error::OutputError;
use crate::picture::place::unfinished;

/// A folder that exists. Dropping it removes what was made and is still empty.
#[derive(Debug)]
pub struct Folder {
    /// The folders that did not exist before, outer ones first.
    made: Vec<PathBuf>,
}

impl Folder {
    /// Makes a folder and its parents if they are missing.
    ///
    /// # Errors
    /// One of them cannot be made, or is a file.
    pub fn prepare(path: &Path) -> Result<Self, OutputError> {
        let mut folder = Self { made: Vec::new() };
        let missing = |p: &&Path| !p.as_os_str().is_empty() && !p.exists();
        let missing: Vec<&Path> = path.ancestors().take_while(missing).collect();
        for new in missing.into_iter().rev() {
            // Locked while the folder is made, so that an interrupt misses none.
            let mut list = unfinished();
            match fs::create_dir(new) {
                Ok(()) => {
                    list.push(new.into());
                    folder.made.push(new.into());
                }
                // `a/..` exists as soon as `a` does, and another process may have made it.
                Err(_) if new.is_dir() => {}
                Err(e) => return Err(OutputError::io(path, "the folder cannot be made", &e)),
            }
        }
        if !path.is_dir() {
            let why = "is a file; name a folder, which need not exist";
            return Err(OutputError::file(path, why));
        }
        Ok(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let mut list = unfinished();
        for folder in self.made.drain(..).rev() {
            list.retain(|f| *f != folder);
            // A folder that holds anything stays: the system removes only empty ones.
            let _ = fs::remove_dir(folder);
        }
    }
}
