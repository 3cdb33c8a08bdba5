//! Shader texts of a host, for live editing.
//!
//! An error of a text is told once. Until the host has another text, frames take the last texts that
//! worked, or else the program's own.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::base::shader::{Program, Sources};
use crate::gpu::kernel_error::KernelError;

/// Texts by the paths of their files.
type Files = Vec<(&'static str, String)>;

/// Texts of a host in the programs of a frame.
#[derive(Default)]
pub struct Texts {
    files: Files,
    version: u32,
}

/// Programs with texts of a host.
#[derive(Default)]
pub struct Edited {
    programs: Vec<Program>,
    version: u32,
}

impl Texts {
    /// The programs, if texts of a host are in them.
    pub fn edited<'a>(&self, programs: impl Iterator<Item = &'a Program>) -> Option<Edited> {
        (!self.files.is_empty()).then(|| Edited {
            programs: programs.cloned().collect(),
            version: self.version,
        })
    }
}

/// What is known of the texts of a host.
#[derive(Default)]
pub struct TextHistory {
    known: Mutex<Known>,
    /// Locked while a host is asked: the last answer is the newest.
    asking: Mutex<()>,
}

#[derive(Default)]
struct Known {
    /// What the host said last of each file, and how often it has changed.
    asked: Vec<(&'static str, Option<String>)>,
    version: u32,
    /// The last texts of frames that began.
    worked: Files,
    /// Programs that cannot be, and the errors that were told of them, since a text changed.
    failed: Vec<Program>,
    told: Vec<String>,
}

fn find<'a, T>(all: &'a [(&str, T)], path: &str) -> Option<&'a T> {
    let found = all.iter().find(|(of, _)| *of == path);
    found.map(|(_, one)| one)
}

/// Programs with the texts of some files.
fn with_texts(programs: &[Program], files: &Files) -> Vec<Program> {
    let mut programs = programs.to_vec();
    for module in programs.iter_mut().flat_map(|p| &mut p.modules) {
        if let Some(text) = find(files, module.path) {
            module.source = text.clone().into();
        }
    }
    programs
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    // Nothing half-made is put there.
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

impl TextHistory {
    /// Puts the texts of a host into programs, and returns those that are used.
    pub fn put(&self, sources: Option<&Sources>, programs: &mut Vec<Program>) -> Texts {
        let Some(sources) = sources else {
            return Texts::default();
        };
        let mut own: Vec<&'static str> = Vec::new();
        for module in programs.iter().flat_map(|p| &p.modules) {
            if !own.contains(&module.path) {
                own.push(module.path);
            }
        }
        let asking = lock(&self.asking);
        // A wrong text is mended even if no program of this frame has it.
        let known: Vec<_> = lock(&self.known)
            .asked
            .iter()
            .map(|(path, _)| *path)
            .collect();
        let older = known.into_iter().filter(|path| !own.contains(path));
        let paths = own.iter().copied().chain(older);
        let asked: Vec<_> = paths.map(|path| (path, sources(path))).collect();
        let mut known = lock(&self.known);
        known.look(&asked);
        drop(asking);
        let of_frame = &asked[..own.len()];
        let text = |(path, text): &(&'static str, Option<String>)| Some((*path, text.clone()?));
        let now: Files = of_frame.iter().filter_map(text).collect();
        let worked = known.worked.iter();
        let worked: Files = worked
            .filter(|(path, _)| find(of_frame, path).is_some())
            .cloned()
            .collect();
        for files in [now, worked] {
            let with = with_texts(programs, &files);
            if !with.iter().any(|program| known.failed.contains(program)) {
                *programs = with;
                let version = known.version;
                return Texts { files, version };
            }
        }
        Texts::default()
    }

    /// A frame has begun with these texts.
    pub fn worked(&self, texts: Texts) {
        let mut known = lock(&self.known);
        let Known { asked, worked, .. } = &mut *known;
        // A file that is gone does not come back.
        let is_there = |path| matches!(find(asked, path), Some(Some(_)));
        worked.retain(|(path, _)| find(&texts.files, path).is_none() && is_there(path));
        known.worked.extend(texts.files);
    }

    /// One of these programs cannot be. Its error is told now, unless the host has other texts by now.
    pub fn failed(&self, edited: &Edited, error: &KernelError) {
        let mut known = lock(&self.known);
        if known.version == edited.version {
            known.fail(&edited.programs, error);
            known.told.push(error.to_string());
        }
    }

    /// The same, if it need not be told: it was told before, or the host has other texts by now.
    pub fn skips(&self, edited: &Edited, error: &KernelError) -> bool {
        let mut known = lock(&self.known);
        if known.version != edited.version {
            return true;
        }
        let was_told = known.told.contains(&error.to_string());
        if was_told {
            known.fail(&edited.programs, error);
        }
        was_told
    }

    /// The last error that was told, if no text has changed since.
    pub fn error(&self) -> Option<String> {
        lock(&self.known).told.last().cloned()
    }
}

impl Known {
    fn fail(&mut self, programs: &[Program], error: &KernelError) {
        let wrong = programs.iter().filter(|p| p.entry == error.entry());
        self.failed.extend(wrong.cloned());
    }

    /// Takes in what a host says of its files. Once it says something else, all is tried again.
    fn look(&mut self, asked: &[(&'static str, Option<String>)]) {
        for (path, text) in asked {
            match self.asked.iter_mut().find(|(of, _)| of == path) {
                Some((_, last)) if last == text => {}
                Some((_, last)) => {
                    last.clone_from(text);
                    self.version += 1;
                    self.failed.clear();
                    self.told.clear();
                }
                None => self.asked.push((path, text.clone())),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::base::shader::Module;

    /// A program of some files.
    fn program(paths: &[&'static str]) -> Program {
        let module = |path: &&'static str| Module {
            path,
            source: "own".into(),
            constants: Vec::new(),
            replaces: None,
        };
        Program::new("main", paths.iter().map(module).collect())
    }

    /// A frame of one program, which cannot be with some texts: the texts that it takes, or why
    /// there is none.
    fn frame(
        history: &TextHistory,
        paths: &[&'static str],
        host: &[(&'static str, &str)],
        is_wrong: fn(&[String]) -> bool,
    ) -> Result<Vec<String>, ()> {
        let host: Files = host
            .iter()
            .map(|(path, text)| (*path, text.to_string()))
            .collect();
        let sources: Sources = Arc::new(move |path: &str| find(&host, path).cloned());
        loop {
            let mut programs = vec![program(paths)];
            let texts = history.put(Some(&sources), &mut programs);
            let sources = programs[0].modules.iter().map(|m| m.source.to_string());
            let sources: Vec<String> = sources.collect();
            if !is_wrong(&sources) {
                history.worked(texts);
                return Ok(sources);
            }
            let edited = texts.edited(programs.iter());
            let edited = edited.expect("the own texts are right");
            let error = program(paths).fault((paths[0], 1), "wrong".into()).into();
            if !history.skips(&edited, &error) {
                history.failed(&edited, &error);
                return Err(());
            }
        }
    }

    #[test]
    fn an_error_is_told_once_and_the_last_texts_that_worked_stay() {
        let (history, paths) = (TextHistory::default(), ["a", "b"]);
        let next = |host: &[(&'static str, &str)]| {
            frame(&history, &paths, host, |texts| {
                texts.contains(&"bad".into())
            })
        };
        let texts = |texts: [&str; 2]| Ok(texts.map(String::from).to_vec());
        assert_eq!(next(&[("a", "good")]), texts(["good", "own"]));
        let both = [("a", "bad"), ("b", "new")];
        assert_eq!(next(&both), Err(()));
        assert_eq!(next(&both), texts(["good", "own"]));
        // The other file was right.
        assert_eq!(next(&[("a", "mended"), both[1]]), texts(["mended", "new"]));
        assert_eq!(next(&both), Err(()), "it is told again");
    }

    #[test]
    fn a_text_may_fail_without_another_one_that_comes_later() {
        let (history, paths) = (TextHistory::default(), ["a", "b"]);
        let next = |host: &[(&'static str, &str)]| {
            let lacks_helper = |texts: &[String]| texts[0] == "calls" && texts[1] != "helper";
            frame(&history, &paths, host, lacks_helper).map(|texts| texts.join(" "))
        };
        assert_eq!(next(&[("a", "calls")]), Err(()));
        assert_eq!(next(&[("a", "calls")]), Ok("own own".into()));
        assert_eq!(
            next(&[("a", "calls"), ("b", "helper")]),
            Ok("calls helper".into())
        );
    }

    #[test]
    fn a_text_that_fails_in_one_plan_stays_in_another() {
        let history = TextHistory::default();
        let host = [("a", "without f"), ("b", "new")];
        let next = |paths: &[&'static str]| {
            let needs_f = |texts: &[String]| texts.len() == 2 && texts[0] == "without f";
            frame(&history, paths, &host, needs_f).map(|texts| texts.join(" "))
        };
        assert_eq!(next(&["a"]), Ok("without f".into()));
        assert_eq!(next(&["a", "b"]), Err(()));
        assert_eq!(next(&["a", "b"]), Ok("own own".into()));
        assert_eq!(next(&["a"]), Ok("without f".into()));
    }

    #[test]
    fn a_frame_without_a_wrong_text_keeps_the_good_one_for_others() {
        let history = TextHistory::default();
        let next = |paths: &[&'static str], host: &[(&'static str, &str)]| {
            let is_bad = |texts: &[String]| texts.contains(&"bad".into());
            frame(&history, paths, host, is_bad).map(|texts| texts.join(" "))
        };
        let good = [("a", "new"), ("b", "good")];
        assert_eq!(next(&["a", "b"], &good), Ok("new good".into()));
        let bad = [("a", "new"), ("b", "bad")];
        assert_eq!(next(&["a"], &bad), Ok("new".into()));
        assert_eq!(next(&["a", "b"], &bad), Err(()));
        assert_eq!(next(&["a", "b"], &bad), Ok("new good".into()));
    }

    #[test]
    fn an_error_of_texts_that_are_gone_is_not_told() {
        let history = TextHistory::default();
        let sources =
            |text: &'static str| -> Sources { Arc::new(move |_: &str| Some(text.into())) };
        let mut old = vec![program(&["a"])];
        let texts = history.put(Some(&sources("bad")), &mut old);
        let edited = texts.edited(old.iter()).expect("texts of a host");
        history.put(Some(&sources("mended")), &mut vec![program(&["a"])]);
        let error = program(&["a"]).fault(("a", 1), "wrong".into()).into();
        assert!(history.skips(&edited, &error));
        history.failed(&edited, &error);
        assert_eq!(history.error(), None);
    }
}
