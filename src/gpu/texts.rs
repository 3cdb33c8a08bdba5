//! Shader texts of a host, for live editing.
//!
//! An error of a text is told once. Until the host has another text, frames take the last texts that
//! worked, or else the program's own.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::base::shader::{Program, Sources};
use crate::gpu::kernel_error::KernelError;

/// Texts by the paths of their files.
pub type Texts = Vec<(&'static str, String)>;

/// What is known of the texts of a host.
#[derive(Default)]
pub struct TextHistory(Mutex<Known>);

#[derive(Default)]
struct Known {
    /// What the host said last of each file.
    asked: Vec<(&'static str, Option<String>)>,
    /// The last texts of frames that began.
    worked: Texts,
    /// Programs that cannot be, and the errors that were told of them, since a text changed.
    failed: Vec<Program>,
    told: Vec<String>,
}

fn find<'a, T>(all: &'a [(&str, T)], path: &str) -> Option<&'a T> {
    let found = all.iter().find(|(of, _)| *of == path);
    found.map(|(_, one)| one)
}

/// Programs with the texts of some files.
fn with_texts(programs: &[Program], texts: &Texts) -> Vec<Program> {
    let mut programs = programs.to_vec();
    for module in programs.iter_mut().flat_map(|p| &mut p.modules) {
        if let Some(text) = find(texts, module.path) {
            module.source = text.clone().into();
        }
    }
    programs
}

impl TextHistory {
    /// Puts the texts of a host into programs, and returns those that are used.
    pub fn put(&self, sources: Option<&Sources>, programs: &mut Vec<Program>) -> Texts {
        let Some(sources) = sources else {
            return Texts::new();
        };
        // A wrong text is mended even if no program of this frame has it.
        let older: Vec<&str> = self.lock().asked.iter().map(|(path, _)| *path).collect();
        let modules = programs.iter().flat_map(|p| &p.modules);
        let mut asked = Vec::new();
        for path in modules.map(|module| module.path).chain(older) {
            if find(&asked, path).is_none() {
                asked.push((path, sources(path)));
            }
        }
        let mut known = self.lock();
        known.look(&asked);
        let text = |(path, text): &(&'static str, Option<String>)| Some((*path, text.clone()?));
        let now: Texts = asked.iter().filter_map(text).collect();
        let worked = known
            .worked
            .iter()
            .filter(|(path, _)| find(&asked, path).is_some());
        let worked: Texts = worked.cloned().collect();
        for texts in [now, worked] {
            let with = with_texts(programs, &texts);
            if !with.iter().any(|program| known.failed.contains(program)) {
                *programs = with;
                return texts;
            }
        }
        Texts::new()
    }

    /// A frame has begun with these texts.
    pub fn worked(&self, texts: Texts) {
        let mut known = self.lock();
        let Known { asked, worked, .. } = &mut *known;
        // A file that is gone does not come back.
        let is_there = |path| matches!(find(asked, path), Some(Some(_)));
        worked.retain(|(path, _)| find(&texts, path).is_none() && is_there(path));
        known.worked.extend(texts);
    }

    /// One of these programs with texts of a host cannot be. Its error is told now.
    pub fn failed(&self, programs: &[Program], error: &KernelError) {
        let mut known = self.lock();
        known.fail(programs, error);
        known.told.push(error.to_string());
    }

    /// The same, if the error was told before.
    pub fn skips(&self, programs: &[Program], error: &KernelError) -> bool {
        let mut known = self.lock();
        let was_told = known.told.contains(&error.to_string());
        if was_told {
            known.fail(programs, error);
        }
        was_told
    }

    /// The last error that was told, if no text has changed since.
    pub fn error(&self) -> Option<String> {
        self.lock().told.last().cloned()
    }

    fn lock(&self) -> MutexGuard<'_, Known> {
        // Nothing half-made is put there.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
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
        let host: Texts = host
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
            assert!(!texts.is_empty(), "the own texts are right");
            let error = program(paths).fault((paths[0], 1), "wrong".into()).into();
            if !history.skips(&programs, &error) {
                history.failed(&programs, &error);
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
}
