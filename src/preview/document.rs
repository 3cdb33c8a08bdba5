//! What is edited: a plan with its history and its file.

use std::fs;
use std::path::{Path, PathBuf, absolute};

use crate::picture::{OutputError, Place, commit};
use crate::plan::Plan;
use crate::preset;
use crate::preview::play::{pose_at, shows_film};

/// The most steps that can be undone. Each is a plan, a few kilobytes.
const MOST_STEPS: usize = 1000;

/// A plan that is edited.
#[derive(Clone, Debug)]
pub struct Document {
    /// The preset's name.
    pub name: String,
    /// The file that it is saved to; `None` for a built-in preset.
    pub path: Option<PathBuf>,
    /// The same place whatever becomes of the file, or the name of a built-in preset. Unsaved work is
    /// kept under it.
    pub place: String,
    /// The plan as it is now.
    pub plan: Plan,
    /// The beat of its film that is shown.
    pub beat: f64,
    /// The plan in the file.
    saved: Plan,
    /// Which work this is: 0, or the number of a restore.
    work: u32,
    /// Restores so far.
    restores: u32,
    past: Vec<Step>,
    future: Vec<Step>,
    /// Steps in the past when the plan was saved.
    saved_at: usize,
    /// The plan before the gesture under way: a drag, or a flight.
    before: Option<Step>,
}

/// A plan that was left.
#[derive(Clone, Debug)]
struct Step {
    plan: Plan,
    beat: f64,
    work: u32,
}

impl Document {
    /// Opens a plan as it was read.
    pub fn new(name: String, path: Option<PathBuf>, plan: Plan) -> Self {
        Self {
            place: place(&name, path.as_deref()),
            name,
            path,
            saved: plan.clone(),
            plan,
            beat: 0.0,
            past: Vec::new(),
            future: Vec::new(),
            saved_at: 0,
            before: None,
            work: 0,
            restores: 0,
        }
    }

    /// Whether there are steps that no file has. Another moment of the film is none.
    pub fn is_changed(&self) -> bool {
        self.past.len() != self.saved_at || self.before.is_some()
    }

    /// The plan in the file.
    pub fn saved(&self) -> &Plan {
        &self.saved
    }

    fn now(&self) -> Step {
        Step {
            plan: self.plan.clone(),
            beat: self.beat,
            work: self.work,
        }
    }

    /// Begins a gesture, unless one is under way. All changes until its end are one step.
    pub fn begin(&mut self) {
        if self.before.is_none() {
            self.before = Some(self.now());
        }
    }

    /// Ends the gesture.
    pub fn end(&mut self) {
        let Some(before) = self.before.take() else {
            return;
        };
        // Only time may have gone on.
        let mut then = before.plan.clone();
        let same_film = shows_film(&then, before.beat) && pose_at(&mut then, self.beat).is_none();
        if before.plan != self.plan && !(same_film && then == self.plan) {
            if self.past.len() < self.saved_at {
                // The saved plan was undone, and is out of reach now.
                self.saved_at = usize::MAX;
            }
            self.push(before);
            self.future.clear();
        }
    }

    /// Makes a change as a step of its own, or as a part of the gesture under way.
    pub fn change(&mut self, change: impl FnOnce(&mut Plan)) {
        let alone = self.before.is_none();
        self.begin();
        change(&mut self.plan);
        if alone {
            self.end();
        }
    }

    /// Takes a step back. Returns the beat at which its plan was left, if there was one.
    pub fn undo(&mut self) -> Option<f64> {
        self.end();
        let step = self.past.pop()?;
        let (beat, left) = (step.beat, self.swap(step));
        self.future.push(left);
        Some(beat)
    }

    /// Takes a step back again. Returns the beat at which its plan was left, if there was one.
    pub fn redo(&mut self) -> Option<f64> {
        self.end();
        let step = self.future.pop()?;
        let (beat, left) = (step.beat, self.swap(step));
        self.past.push(left);
        Some(beat)
    }

    /// Takes the plan of a step, and returns the one that is left.
    fn swap(&mut self, step: Step) -> Step {
        let left = self.now();
        (self.plan, self.work) = (step.plan, step.work);
        left
    }

    /// Goes to another moment of the film. Changes that no file has and that are not of the film are
    /// left by a step, so that an undo returns to them. A moment that does not fit changes nothing;
    /// returns why it does not.
    pub fn go_to(&mut self, beat: f64) -> Option<String> {
        let mut posed = self.plan.clone();
        if let Some(wrong) = pose_at(&mut posed, beat) {
            return Some(wrong);
        }
        let alone = beat != self.beat && self.before.is_none() && !self.plan.tracks.is_empty();
        if alone && self.is_changed() && !shows_film(&self.plan, self.beat) {
            // What was undone can still be done again after it.
            if self.saved_at > self.past.len() {
                self.saved_at = self.saved_at.saturating_add(1);
            }
            self.push(self.now());
        }
        (self.plan, self.beat) = (posed, beat);
        None
    }

    /// Takes in work that was kept, as a step.
    pub fn restore(&mut self, plan: Plan) {
        self.end();
        self.change(|now| *now = plan);
        self.restores += 1;
        self.work = self.restores;
    }

    /// Which work this is: 0, or the number of the restore that it came from. An undo of a restore
    /// returns to the work before.
    pub fn work(&self) -> u32 {
        self.work
    }

    /// Makes all steps of some works steps of the present one.
    pub fn join(&mut self, works: impl Fn(u32) -> bool) {
        for step in self.past.iter_mut().chain(&mut self.future) {
            if works(step.work) {
                step.work = self.work;
            }
        }
    }

    fn push(&mut self, step: Step) {
        self.past.push(step);
        if self.past.len() > MOST_STEPS {
            self.past.remove(0);
            self.saved_at = self.saved_at.checked_sub(1).unwrap_or(usize::MAX);
        }
    }

    /// Takes in the file as another program has written it. It is a step that can be undone.
    pub fn reload(&mut self, plan: Plan) {
        self.end();
        self.saved = plan.clone();
        self.change(|now| *now = plan);
        self.saved_at = self.past.len();
    }

    /// Writes a plan, which is this one but for its still, to its file. A built-in preset, a picture
    /// and a write-protected file get a new one in `folder`. The file is replaced at once or not at
    /// all.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&mut self, folder: &Path, plan: Plan) -> Result<PathBuf, OutputError> {
        let is_toml = |path: &&PathBuf| path.extension().is_some_and(|e| e == "toml");
        let may_change = |path: &&PathBuf| {
            fs::metadata(path).map_or(true, |file| !file.permissions().readonly())
        };
        // A picture that carries a preset stays as it is.
        let own = self.path.as_ref().filter(is_toml).filter(may_change);
        let path = match own {
            Some(path) => path.clone(),
            None => unused(folder, &self.name, "toml"),
        };
        write(&path, preset::write_beside(&plan, &path).as_bytes())?;
        self.end();
        self.saved = plan;
        for plan in [&mut self.saved, &mut self.plan] {
            preset::move_beside(plan, &path);
        }
        self.saved_at = self.past.len();
        if self.path.as_ref() != Some(&path) {
            self.place = place(&self.name, Some(&path));
        }
        self.path = Some(path.clone());
        Ok(path)
    }
}

fn place(name: &str, path: Option<&Path>) -> String {
    // The file may be gone.
    let whole = |path| fs::canonicalize(path).or_else(|_| absolute(path)).ok();
    match path.and_then(whole) {
        Some(path) => path.to_string_lossy().into_owned(),
        None => name.into(),
    }
}

/// Writes a file whole or not at all.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, content: &[u8]) -> Result<(), OutputError> {
    let mut place = Place::prepare(path)?;
    place.write_all(content)?;
    commit(vec![place])
}

/// `NAME-1.toml`, or the next number that is free.
pub fn unused(folder: &Path, name: &str, ending: &str) -> PathBuf {
    let path = |n: u32| folder.join(format!("{name}-{n}.{ending}"));
    let free = (1..u32::MAX).map(path).find(|path| !path.exists());
    free.unwrap_or_else(|| path(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::play::{set_key, set_view};
    use crate::scene::Scene;
    use glam::DVec3;

    fn document() -> Document {
        let scene = Scene::all().into_iter().next().expect("a scene");
        Document::new("box".into(), None, Plan::new(scene))
    }

    #[test]
    fn a_gesture_is_one_step_and_undo_goes_back_and_forth() {
        let mut doc = document();
        let first = doc.plan.clone();
        doc.begin();
        for fov in [41.0, 42.0, 43.0] {
            doc.begin();
            doc.change(|plan| plan.camera.fov = fov);
        }
        doc.end();
        doc.change(|plan| plan.look.fog = 1.0);
        doc.change(|_| {});
        let last = doc.plan.clone();
        assert!(doc.is_changed());
        assert_eq!(doc.undo(), Some(0.0));
        assert!(doc.plan.look.fog == 0.0 && doc.plan.camera.fov == 43.0);
        doc.beat = 2.0;
        assert_eq!(doc.undo(), Some(0.0));
        assert!(doc.plan == first && !doc.is_changed());
        assert_eq!(doc.undo(), None);
        assert_eq!(
            [doc.redo(), doc.redo(), doc.redo()],
            [Some(2.0), Some(0.0), None]
        );
        assert_eq!(doc.plan, last);
        // A change forgets what was undone.
        doc.undo();
        doc.change(|plan| plan.camera.fov = 50.0);
        assert_eq!(doc.redo(), None);
    }

    #[test]
    fn a_film_that_goes_on_is_no_step() {
        let mut doc = document();
        doc.plan.camera.eye = DVec3::new(0.0, -9.0, 1.0);
        for (beat, x) in [(0.0, 0.0), (4.0, 3.0)] {
            doc.plan.camera.eye.x = x;
            set_view(&mut doc.plan, beat);
        }
        let end_at = |doc: &mut Document, beat, x: f64| {
            doc.begin();
            doc.beat = beat;
            assert_eq!(pose_at(&mut doc.plan, beat), None);
            doc.plan.camera.eye.x += x;
            doc.end();
            doc.is_changed()
        };
        // A view that is not of the film is not lost by a gesture that shows the film.
        assert!(end_at(&mut doc, 4.0, 0.5) && end_at(&mut doc, 2.0, 0.0));
        doc.past.clear();
        assert!(!end_at(&mut doc, 3.0, 0.0));
        assert!(end_at(&mut doc, 3.0, 0.5));
    }

    #[test]
    fn a_moment_that_does_not_fit_is_no_step() {
        let mut doc = document();
        for (beat, fov) in [(0.0, 40.0), (4.0, 400.0)] {
            doc.plan.camera.fov = fov;
            assert!(set_key(&mut doc.plan, "camera.fov", beat));
        }
        assert_eq!(doc.go_to(0.0), None);
        doc.change(|plan| plan.look.fog = 1.0);
        for beat in [3.9, 3.95, 4.0] {
            assert!(doc.go_to(beat).is_some());
        }
        assert_eq!((doc.past.len(), doc.beat), (1, 0.0));
    }

    #[test]
    fn each_step_knows_which_work_it_is_of() {
        let mut doc = document();
        let kept = |samples| Plan {
            samples,
            ..document().plan
        };
        // A restore in the middle of a gesture ends it.
        doc.begin();
        doc.change(|plan| plan.camera.fov = 50.0);
        doc.restore(kept(2));
        doc.change(|plan| plan.camera.fov = 60.0);
        doc.restore(kept(3));
        type Change = fn(&mut Document) -> Option<f64>;
        let mut works = |step: Change| [0; 5].map(|_| (doc.work(), step(&mut doc)).0);
        assert_eq!(works(Document::undo), [2, 1, 1, 0, 0]);
        assert_eq!(works(Document::redo), [0, 0, 1, 1, 2]);
        doc.undo();
        doc.restore(kept(4));
        // A work that is kept nowhere is the present one after a save.
        doc.join(|work| work == 0);
        assert_eq!([0; 5].map(|_| (doc.work(), doc.undo()).0), [3, 1, 1, 3, 3]);
    }

    #[test]
    fn a_view_that_is_left_by_another_moment_is_a_step() {
        let mut doc = document();
        for (beat, x) in [(0.0, -9.0), (4.0, -12.0)] {
            doc.plan.camera.eye = DVec3::new(0.0, x, 1.0);
            doc.change(|plan| set_view(plan, beat));
        }
        assert_eq!(doc.go_to(1.0), None);
        let steps = doc.past.len();
        doc.change(|plan| plan.camera.eye.z = 3.0);
        let flown = doc.plan.clone();
        assert_eq!(doc.go_to(2.0), None);
        // A film that goes on from there is none.
        assert_eq!(doc.go_to(3.0), None);
        assert_eq!(doc.past.len(), steps + 2);
        assert_eq!((doc.undo(), doc.plan == flown), (Some(1.0), true));
        // Nor is a gesture under way, but it keeps the view before it.
        for made in [1, 0] {
            let steps = doc.past.len();
            doc.begin();
            assert_eq!(doc.go_to(3.5), None);
            doc.end();
            assert_eq!(doc.past.len(), steps + made);
        }
    }

    #[test]
    fn a_built_in_preset_is_saved_to_a_new_file_and_then_to_that() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut doc = document();
        doc.change(|plan| plan.camera.fov = 33.0);
        let save = |doc: &mut Document| doc.save(folder.path(), doc.plan.clone()).expect("saved");
        let path = save(&mut doc);
        assert_eq!(path, folder.path().join("box-1.toml"));
        assert!(!doc.is_changed());
        doc.change(|plan| plan.camera.fov = 34.0);
        assert!(doc.is_changed());
        assert_eq!(save(&mut doc), path);
        let text = std::fs::read_to_string(&path).expect("a file");
        let mut read = preset::read(&text, "box").expect("a preset");
        read.set_folder(folder.path());
        assert_eq!(read, doc.plan);
        let again = save(&mut document());
        assert_eq!(again, folder.path().join("box-2.toml"));
        // A write-protected file stays as it is.
        let mut protected = fs::metadata(&path).expect("a file").permissions();
        protected.set_readonly(true);
        fs::set_permissions(&path, protected).expect("set");
        doc.change(|plan| plan.camera.fov = 35.0);
        assert_eq!(save(&mut doc), folder.path().join("box-3.toml"));
    }
}
