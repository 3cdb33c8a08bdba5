//! Files that change while they are shown: the preset, and the texts of shaders.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use crate::base::shader::Sources;

/// A file that is missing at so many questions one after the other has vanished: an editor that
/// replaces it is quicker.
const VANISHED: u32 = 4;

/// When files were written last.
#[derive(Debug, Default)]
pub struct Watched {
    files: Vec<PathBuf>,
    seen: Vec<Option<SystemTime>>,
    missing: u32,
}

fn written(path: &Path) -> Option<SystemTime> {
    fs::metadata(path).ok()?.modified().ok()
}

impl Watched {
    /// Watches files as they are now.
    pub fn new(files: Vec<PathBuf>) -> Self {
        let seen = files.iter().map(|file| written(file)).collect();
        Self {
            files,
            seen,
            missing: 0,
        }
    }

    /// A file that is gone and will not come back by itself, once.
    pub fn vanished(&mut self) -> Option<PathBuf> {
        let gone = self.files.iter().find(|file| written(file).is_none());
        self.missing = if gone.is_some() { self.missing + 1 } else { 0 };
        let gone = gone.filter(|_| self.missing == VANISHED).cloned()?;
        // The same file may come back.
        self.seen.fill(None);
        Some(gone)
    }

    /// Whether there are other files now than those that are watched, and have been for so long that
    /// no editor is replacing one.
    pub fn others(&mut self, now: &[PathBuf]) -> bool {
        let same = self.files.len() == now.len() && now.iter().all(|f| self.files.contains(f));
        self.missing = if same { 0 } else { self.missing + 1 };
        self.missing == VANISHED
    }

    /// Whether any was written since the last question. One that is gone for now did not change:
    /// editors replace files.
    pub fn changed(&mut self) -> bool {
        let mut changed = false;
        for (file, seen) in self.files.iter().zip(&mut self.seen) {
            let now = written(file);
            if now.is_some() && now != *seen {
                *seen = now;
                changed = true;
            }
        }
        changed
    }
}

/// The shader files of a folder and the folders in it.
pub fn files_in(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths = entries.flatten().map(|entry| entry.path());
    let files = paths.flat_map(|path| match path.is_dir() {
        true => files_in(&path),
        false => vec![path],
    });
    let is_shader = |path: &PathBuf| path.extension().is_some_and(|e| e == "wgsl");
    files.filter(is_shader).collect()
}

/// The texts of shaders in a folder laid out like `wgsl/` of the sources. The program has its own
/// text for a file that is not there.
pub fn sources(folder: PathBuf) -> Sources {
    Arc::new(move |path: &str| {
        let path = path.strip_prefix("wgsl/").unwrap_or(path);
        fs::read_to_string(folder.join(path)).ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_written_again_has_changed_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.toml");
        let mut watched = Watched::new(vec![file.clone()]);
        assert!(!watched.changed());
        fs::write(&file, "1").expect("written");
        assert!(watched.changed() && !watched.changed());
        let aside = folder.path().join("b.toml");
        fs::rename(&file, &aside).expect("renamed");
        assert!(!watched.changed());
        let said: Vec<bool> = (0..6).map(|_| watched.vanished().is_some()).collect();
        assert_eq!(said, [false, false, false, true, false, false]);
        fs::rename(&aside, &file).expect("renamed");
        assert!(watched.vanished().is_none() && watched.changed() && !watched.changed());
        fs::remove_file(&file).expect("removed");
        assert_eq!(files_in(folder.path()), Vec::<PathBuf>::new());
    }
}
