//! Unsaved work, kept outside the preset's file until it is saved.

use std::fs::{self, File};
use std::path::{Path, PathBuf, absolute};

use crate::picture::OutputError;
use crate::plan::Plan;
use crate::preset;
use crate::preview::document::{Document, write};
use crate::preview::play::with_still;

/// The most works that are kept of one document.
const SLOTS: u32 = 9;

/// The file for a document: named after the preset, and after its folder if it is in a file.
fn path(folder: &Path, document: &Document, slot: u32) -> PathBuf {
    // The file may have vanished.
    let whole = |path: &PathBuf| fs::canonicalize(path).or_else(|_| absolute(path)).ok();
    let place: String = match document.path.as_ref().and_then(whole) {
        Some(path) => path.to_string_lossy().into_owned(),
        None => document.name.clone(),
    };
    // Two places never have one name.
    let plain = |c: char| match c {
        '/' => "_".to_string(),
        c if c.is_alphanumeric() => c.to_string(),
        c => format!("%{:x}", u32::from(c)),
    };
    let place: String = place.chars().map(plain).collect();
    // Work that nobody has taken yet is not written over.
    let number = match slot.min(SLOTS - 1) {
        0 => String::new(),
        n => format!("-{n}"),
    };
    folder.join(format!("unsaved-{place}{number}.toml"))
}

/// Where the unsaved work of a window is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// In none yet: the first free one from this on will do. Another window may have any.
    After(u32),
    /// In this one.
    Own(u32),
}

impl Slot {
    /// The first slot that is not this one's.
    pub fn next(self) -> u32 {
        match self {
            Self::After(slot) => slot,
            Self::Own(slot) => slot + 1,
        }
    }

    /// Keeps the document's plan as it would be saved.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn keep(&mut self, folder: Option<&Path>, document: &Document) -> Result<(), OutputError> {
        let Some(folder) = folder else { return Ok(()) };
        let _ = fs::create_dir_all(folder);
        let plan = with_still(&document.plan, document.saved(), document.beat);
        let slot = match *self {
            Self::Own(slot) => slot,
            Self::After(first) => {
                let is_free = |slot: &u32| File::create_new(path(folder, document, *slot)).is_ok();
                (first..SLOTS).find(is_free).unwrap_or(SLOTS - 1)
            }
        };
        *self = Self::Own(slot);
        write(
            &path(folder, document, slot),
            preset::write(&plan).as_bytes(),
        )
    }

    /// Forgets what was kept.
    pub fn drop(&mut self, folder: Option<&Path>, document: &Document) {
        if let (Some(folder), Self::Own(slot)) = (folder, *self) {
            let _ = fs::remove_file(path(folder, document, slot));
            *self = Self::After(slot);
        }
    }
}

/// What was kept last of a document and differs from it, with its slot.
pub fn find(folder: Option<&Path>, document: &Document) -> Option<(u32, Plan)> {
    let folder = folder?;
    let mut slots = (0..SLOTS).rev();
    slots.find_map(|slot| Some((slot, read(folder, document, slot)?)))
}

fn read(folder: &Path, document: &Document, slot: u32) -> Option<Plan> {
    let text = fs::read_to_string(path(folder, document, slot)).ok()?;
    let mut plan = preset::read(&text, "unsaved work").ok()?;
    if let Some(parent) = document.path.as_ref().and_then(|path| path.parent()) {
        plan.set_folder(parent);
    }
    (plan != document.plan).then_some(plan)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn works_of_two_presets_are_two_even_if_a_file_vanishes() {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = Scene::all().into_iter().next().expect("a scene");
        let place = |name: &str| {
            let file = folder.path().join(name);
            let document = Document::new("box".into(), Some(file), Plan::new(scene.clone()));
            path(folder.path(), &document, 0)
        };
        assert!(place("a-b.toml") != place("a_b.toml"));
        let gone = place("a.toml");
        fs::write(folder.path().join("a.toml"), "").expect("written");
        assert_eq!(place("a.toml"), gone);
    }

    #[test]
    fn work_is_kept_until_it_is_dropped() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = Some(folder.path());
        let scene = Scene::all().into_iter().next().expect("a scene");
        let mut document = Document::new("box".into(), None, Plan::new(scene));
        // Two windows.
        let [mut one, mut two] = [Slot::After(0); 2];
        one.keep(at, &document).expect("kept");
        assert_eq!(find(at, &document), None);
        document.plan.camera.fov = 33.0;
        one.keep(at, &document).expect("kept");
        let older = document.plan.clone();
        document.plan.camera.fov = 34.0;
        two.keep(at, &document).expect("kept");
        let newer = document.plan.clone();
        document.plan.camera.fov = 40.0;
        assert_eq!(find(at, &document), Some((1, newer)));
        two.drop(at, &document);
        assert_eq!(find(at, &document), Some((0, older.clone())));
        // What is another's is not dropped.
        two.drop(at, &document);
        assert_eq!(find(at, &document), Some((0, older)));
        one.drop(at, &document);
        assert_eq!(find(at, &document), None);
        assert_eq!(find(None, &document), None);
    }
}
