//! A folder for results: made where it is missing, and gone again if nothing has come to
//! lie in it, be it by an error or by an interrupt.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::picture::error::OutputError;

/// All folders that were made and are not in use for good yet, outer ones first.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn made() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of names cannot be half changed.
    MADE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A folder that is there. Dropped, it takes away what was made and is still empty.
#[derive(Debug)]
pub struct Folder {
    /// What did not exist before, outer ones first.
    made: Vec<PathBuf>,
}

impl Folder {
    /// Makes a folder, and those that it lies in, where they are missing.
    ///
    /// # Errors
    /// One of them cannot be made, or is a file.
    pub fn prepare(path: &Path) -> Result<Self, OutputError> {
        let mut folder = Self { made: Vec::new() };
        let missing = |p: &&Path| !p.as_os_str().is_empty() && !p.exists();
        let missing: Vec<&Path> = path.ancestors().take_while(missing).collect();
        for new in missing.into_iter().rev() {
            // Locked while it comes to be, so that an interrupt misses none.
            let mut list = made();
            match fs::create_dir(new) {
                Ok(()) => {
                    list.push(new.into());
                    folder.made.push(new.into());
                }
                // `a/..` is there as soon as `a` is; somebody else may have made it, too.
                Err(_) if new.is_dir() => {}
                Err(e) => return Err(OutputError::io(path, "the folder cannot be made", &e)),
            }
        }
        if !path.is_dir() {
            let why = "is a file; name a folder, or one that is still to be made";
            return Err(OutputError::file(path, why));
        }
        Ok(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let mut list = made();
        for folder in self.made.drain(..).rev() {
            list.retain(|f| *f != folder);
            // One that holds anything stays: the system removes only empty ones.
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Takes away all that were made and are still empty: for the moment before the process
/// ends.
pub(crate) fn clear() {
    for folder in made().drain(..).rev() {
        let _ = fs::remove_dir(folder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_made_goes_unless_something_lies_in_it() {
        let base = std::env::temp_dir().join(format!("conemarch-folder-{}", std::process::id()));
        let inner = base.join("one/two");
        drop(Folder::prepare(&inner).expect("can be made"));
        assert!(!base.exists());
        let folder = Folder::prepare(&inner).expect("can be made");
        fs::write(base.join("one/file"), "kept").expect("can be written");
        drop(folder);
        assert!(!inner.exists() && base.join("one/file").exists());
        // What was there before stays, though it is empty.
        fs::create_dir(&inner).expect("can be made");
        drop(Folder::prepare(&inner).expect("is there"));
        assert!(inner.is_dir());
        assert!(Folder::prepare(&base.join("one/file")).is_err());
        fs::remove_dir_all(base).expect("can be removed");
    }
}
