//! Shader texts of a host, for live editing.
//!
//! A text that fails is told once, by the frame that met it. Until the host has another text, frames
//! take the last one that worked, or else the program's own.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::base::shader::{Program, Sources};

/// Texts by the paths of their files.
pub type Texts = Vec<(&'static str, String)>;

/// What is known of the texts of a host.
#[derive(Default)]
pub struct TextHistory(Mutex<Known>);

#[derive(Default)]
struct Known {
    /// The last ones that worked.
    worked: Texts,
    /// Those that failed, together.
    failed: Texts,
}

fn find<'a>(texts: &'a Texts, path: &str) -> Option<&'a String> {
    let found = texts.iter().find(|(of, _)| *of == path);
    found.map(|(_, text)| text)
}

impl TextHistory {
    /// Puts the texts of a host into programs, and returns those that are used.
    pub fn put(&self, sources: Option<&Sources>, programs: &mut [Program]) -> Texts {
        let mut used = Texts::new();
        let Some(sources) = sources else {
            return used;
        };
        let mut known = self.lock();
        // They may have failed because of each other.
        if known
            .failed
            .iter()
            .any(|(path, text)| sources(path).as_ref() != Some(text))
        {
            known.failed.clear();
        }
        for module in programs.iter_mut().flat_map(|p| &mut p.modules) {
            let path = module.path;
            if find(&used, path).is_none() {
                let text = match find(&known.failed, path) {
                    Some(_) => find(&known.worked, path).cloned(),
                    None => sources(path),
                };
                used.extend(text.map(|text| (path, text)));
            }
            if let Some(text) = find(&used, path) {
                module.source = text.clone().into();
            }
        }
        used
    }

    /// A frame has begun with these texts.
    pub fn worked(&self, texts: Texts) {
        let mut known = self.lock();
        known
            .worked
            .retain(|(path, _)| find(&texts, path).is_none());
        known.worked.extend(texts);
    }

    /// A frame could not begin with these texts.
    pub fn failed(&self, texts: Texts) {
        let mut known = self.lock();
        let new = texts
            .iter()
            .filter(|(path, text)| find(&known.worked, path) != Some(text));
        let new: Texts = new.cloned().collect();
        // They worked in the programs of another plan.
        let failed = if new.is_empty() { texts } else { new };
        known.worked.retain(|of| !failed.contains(of));
        known.failed.extend(failed);
    }

    fn lock(&self) -> MutexGuard<'_, Known> {
        // Nothing half-made is put there.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;
    use std::sync::Arc;

    use super::*;
    use crate::base::shader::Module;

    /// The texts that a program of two modules gets.
    fn put(history: &TextHistory, texts: &[(&str, &str)]) -> (Texts, [String; 2]) {
        let own = |(path, text): &(&str, &str)| (path.to_string(), text.to_string());
        let texts: HashMap<String, String> = texts.iter().map(own).collect();
        let sources: Sources = Arc::new(move |path: &str| texts.get(path).cloned());
        let module = |path| Module {
            path,
            source: "own".into(),
            constants: Vec::new(),
            replaces: None,
        };
        let mut program = [Program::new("main", ["a", "b"].map(module).into())];
        let used = history.put(Some(&sources), &mut program);
        (
            used,
            [0, 1].map(|n| program[0].modules[n].source.to_string()),
        )
    }

    #[test]
    fn a_text_that_fails_gives_way_to_the_last_that_worked_until_it_changes() {
        let history = TextHistory::default();
        let (used, texts) = put(&history, &[("a", "good")]);
        assert_eq!(texts, ["good", "own"]);
        history.worked(used);
        let both = [("a", "bad"), ("b", "new")];
        let (used, texts) = put(&history, &both);
        assert_eq!(texts, ["bad", "new"]);
        history.failed(used);
        assert_eq!(put(&history, &both).1, ["good", "own"]);
        // The other was right.
        assert_eq!(
            put(&history, &[("a", "mended"), both[1]]).1,
            ["mended", "new"]
        );
        // A text that comes again is tried again.
        assert_eq!(put(&history, &both).1, ["bad", "new"]);
    }

    #[test]
    fn a_text_that_works_in_one_program_alone_gives_way_to_the_own() {
        let history = TextHistory::default();
        let texts = [("a", "for one plan")];
        history.worked(put(&history, &texts).0);
        history.failed(put(&history, &texts).0);
        assert_eq!(put(&history, &texts).1, ["own", "own"]);
    }
}
