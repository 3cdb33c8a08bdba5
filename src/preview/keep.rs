//! Unsaved work, kept outside the preset's file until it is saved.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use crate::picture::OutputError;
use crate::plan::Plan;
use crate::preset;
use crate::preview::document::{Document, write};
use crate::preview::play::with_still;

/// The most works that are kept of one document. Nobody leaves so many.
const SLOTS: u32 = 1000;

/// The first line of kept work, before the place of its preset.
const TITLE: &str = "# unsaved work of ";

/// The most letters of a place in the name of a file. File systems allow 255 bytes.
const MOST_LETTERS: usize = 40;

/// The file for a document, named after the place of its preset: by its end, and by a number for the
/// whole of it if it is long or has other letters.
fn path(folder: &Path, document: &Document, slot: u32) -> PathBuf {
    let whole = &document.place;
    let plain = |c: char| if c.is_alphanumeric() { c } else { '_' };
    let letters: Vec<char> = whole.chars().map(plain).collect();
    let end = letters.len().saturating_sub(MOST_LETTERS);
    let mut place: String = letters[end..].iter().collect();
    if end > 0 || !whole.chars().all(char::is_alphanumeric) {
        // FNV-1a.
        let hash = whole.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        place = format!("{place}-{hash:016x}");
    }
    let number = match slot {
        0 => String::new(),
        n => format!("-{n}"),
    };
    folder.join(format!("unsaved-{place}{number}.toml"))
}

/// Where the unsaved work of a window is kept. A window locks its slot as long as it is open, so that
/// no other one takes its work for that of a crash.
#[derive(Debug, Default)]
pub struct Slot {
    held: Option<Held>,
    /// What is kept there, if this window has written it.
    kept: Option<Plan>,
}

/// A file of a slot. It stays the same when its document is saved to another place.
#[derive(Debug)]
struct Held {
    file: PathBuf,
    /// The place of the document.
    of: String,
    #[expect(dead_code, reason = "its end unlocks it")]
    lock: Lock,
}

/// A file that is locked as long as this lives.
#[derive(Debug)]
struct Lock(
    PathBuf,
    #[expect(dead_code, reason = "its end unlocks it")] File,
);

impl Lock {
    /// Locks the slot of a file.
    fn beside(path: &Path) -> Option<Self> {
        let path = path.with_extension("lock");
        let file = File::create(&path).ok()?;
        file.try_lock().ok()?;
        Some(Self(path, file))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

impl Held {
    /// Locks a slot, unless another window has it.
    fn take(folder: &Path, document: &Document, slot: u32) -> Option<Self> {
        let file = path(folder, document, slot);
        Some(Self {
            lock: Lock::beside(&file)?,
            of: document.place.clone(),
            file,
        })
    }
}

impl Slot {
    /// That of work of an earlier session; `None` if another window has taken it.
    pub fn of(folder: Option<&Path>, document: &Document, slot: u32) -> Option<Self> {
        let held = Held::take(folder?, document, slot)?;
        held.file.exists().then_some(Self {
            held: Some(held),
            kept: None,
        })
    }

    /// What this window has kept there.
    pub fn kept(&self) -> Option<&Plan> {
        self.kept.as_ref()
    }

    /// Keeps the document's plan as it would be saved. Returns whether there is a place for it.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn keep(
        &mut self,
        folder: Option<&Path>,
        document: &Document,
    ) -> Result<bool, OutputError> {
        let Some(folder) = folder else {
            return Ok(false);
        };
        let _ = fs::create_dir_all(folder);
        let plan = with_still(&document.plan, document.saved(), document.beat);
        // Work that nobody has taken yet is not written over.
        let mut free = (0..SLOTS).filter(|slot| !path(folder, document, *slot).exists());
        if self.held.is_none() {
            self.held = free.find_map(|slot| Held::take(folder, document, slot));
        }
        let Some(held) = &self.held else {
            return Ok(false);
        };
        let text = format!("{TITLE}{}\n{}", held.of, preset::write(&plan));
        write(&held.file, text.as_bytes())?;
        self.kept = Some(document.plan.clone());
        Ok(true)
    }

    /// Forgets what was kept.
    pub fn drop(&mut self) {
        self.kept = None;
        if let Some(held) = self.held.take() {
            let _ = fs::remove_file(held.file);
        }
    }
}

/// What was kept last of a document by a window that is gone, and differs from it, with its slot.
pub fn find(folder: Option<&Path>, document: &Document) -> Option<(u32, Plan)> {
    let folder = folder?;
    let written =
        |slot| fs::metadata(path(folder, document, slot)).and_then(|file| file.modified());
    let slots = (0..SLOTS).filter_map(|slot| Some((written(slot).ok()?, slot)));
    let mut slots: Vec<_> = slots.collect();
    slots.sort();
    let unlocked = |slot: &u32| Held::take(folder, document, *slot).is_some();
    let mut slots = slots.into_iter().rev().map(|(_, slot)| slot);
    slots.find_map(|slot| {
        let plan = read(folder, document, slot)?;
        unlocked(&slot).then_some((slot, plan))
    })
}

/// Where to find the last work that was kept of another document by a window that is gone, and how to
/// take it.
pub fn elsewhere(folder: Option<&Path>, document: &Document) -> Option<String> {
    let files = fs::read_dir(folder?)
        .ok()?
        .flatten()
        .map(|file| file.path());
    let is_work = |path: &PathBuf| path.extension().is_some_and(|e| e == "toml");
    let mut files: Vec<_> = files.filter(is_work).collect();
    files.sort_by_cached_key(|path| fs::metadata(path).and_then(|file| file.modified()).ok());
    files.into_iter().rev().find_map(|path| {
        let text = fs::read_to_string(&path).ok()?;
        let place = text.lines().next()?.strip_prefix(TITLE)?;
        let mut kept = preset::read(&text, "unsaved work").ok()?;
        if place == document.place || Lock::beside(&path).is_none() {
            return None;
        }
        let file = preset::file(Path::new(place));
        if let Some(parent) = file.as_ref().and_then(|file| file.parent()) {
            kept.set_folder(parent);
        }
        match preset::load(Path::new(place), &[]) {
            Ok(preset) if preset.plan == kept => None,
            Ok(_) => Some(format!("there is unsaved work: open {place} to take it")),
            Err(_) => Some(format!(
                "there is unsaved work of {place}, which cannot be read; copy {} there to take it",
                path.display()
            )),
        }
    })
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
        let [mut one, mut two] = [Slot::default(), Slot::default()];
        one.keep(at, &document).expect("kept");
        assert_eq!(find(at, &document), None);
        document.plan.camera.fov = 33.0;
        one.keep(at, &document).expect("kept");
        let older = document.plan.clone();
        document.plan.camera.fov = 34.0;
        two.keep(at, &document).expect("kept");
        let newer = document.plan.clone();
        document.plan.camera.fov = 40.0;
        // What an open window keeps is no unsaved work of another time.
        assert_eq!(find(at, &document), None);
        assert!(Slot::of(at, &document, 1).is_none());
        // One of them crashes, and then the other.
        let crash = |slot: &mut Slot| *slot = Slot::default();
        crash(&mut two);
        assert_eq!(find(at, &document), Some((1, newer.clone())));
        crash(&mut one);
        assert_eq!(find(at, &document), Some((1, newer)));
        Slot::of(at, &document, 1).expect("free").drop();
        assert_eq!(find(at, &document), Some((0, older)));
        Slot::of(at, &document, 0).expect("free").drop();
        assert_eq!(find(at, &document), None);
        assert_eq!(find(None, &document), None);
        assert!(!two.keep(None, &document).expect("no error"), "nowhere");
        // Who opens another preset hears of it.
        let scene = document.plan.scene.clone();
        let other = Document::new("other".into(), None, Plan::new(scene));
        assert_eq!(elsewhere(at, &other), None);
        one.keep(at, &document).expect("kept");
        assert_eq!(elsewhere(at, &other), None, "its window is open");
        crash(&mut one);
        let file = path(folder.path(), &document, 0);
        let text = elsewhere(at, &other).expect("there is work");
        assert!(text.contains(&file.display().to_string()), "{text}");
        assert_eq!(elsewhere(at, &document), None);
        // Saved to another place, the work is kept in its file and dropped from there.
        let mut slot = Slot::of(at, &document, 0).expect("free");
        document.place = "another".into();
        slot.keep(at, &document).expect("kept");
        assert!(file.exists() && !path(folder.path(), &document, 0).exists());
        slot.drop();
        assert!(!file.exists());
    }
}
