//! Reads the text of a preset and its overrides into a plan, and checks every value.

use std::path::Path;

use toml::Value;

use crate::base::key::{Fault, Key, Slot, text};
use crate::formula::Formula;
use crate::plan::Plan;
use crate::preset::document::{
    Entry, Override, SECTIONS, Said, brief, line_of, parse, unknown_section,
};
use crate::preset::error::{PresetError, place};
use crate::preset::nearest::nearest;
use crate::scene::Scene;

/// Words for `scene.kind`.
fn kinds() -> Vec<&'static str> {
    let mut kinds: Vec<&str> = Scene::all().iter().map(|s| s.kind()).collect();
    // One distance scene for each formula.
    kinds.dedup();
    kinds
}

/// Reads a preset. `origin` is its name in errors, like the path of a file.
///
/// # Errors
/// Wrong syntax, unknown names, wrong types, impossible values. The error names file, line,
/// key, value and a valid alternative.
pub fn read(text: &str, origin: &str) -> Result<Plan, PresetError> {
    let entries = parse(text, origin)?;
    let folder = Path::new("");
    Reader {
        text,
        origin,
        folder,
    }
    .plan(&entries)
}

/// Reads a preset with overrides. It must also be valid without them.
///
/// An override of `scene.kind` or `scene.formula` that changes it drops the preset's
/// other values of the scene: they belong to another one.
///
/// # Errors
/// As [`read`]. Faults that only the overrides cause are reported at the overrides.
pub fn read_with(text: &str, origin: &str, overrides: &[Override]) -> Result<Plan, PresetError> {
    Ok(read_in(Path::new(""), text, origin, overrides)?.plan)
}

/// A plan, and where each of its values was said.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    pub plan: Plan,
    text: String,
    origin: String,
    entries: Vec<Entry>,
}

impl Reading {
    /// A fault of the plan, at the place where its key was said.
    pub fn blame(&self, fault: Fault) -> PresetError {
        let reader = Reader {
            text: &self.text,
            origin: &self.origin,
            folder: Path::new(""),
        };
        reader.fault(&mut self.plan.clone(), &self.entries, fault)
    }
}

/// As [`read_with`]; files that the preset names are relative to a folder.
pub(super) fn read_in(
    folder: &Path,
    text: &str,
    origin: &str,
    overrides: &[Override],
) -> Result<Reading, PresetError> {
    let reader = Reader {
        text,
        origin,
        folder,
    };
    let mut entries = parse(text, origin)?;
    let alone = reader.plan(&entries)?;
    let reading = |plan, entries| Reading {
        plan,
        text: text.into(),
        origin: origin.into(),
        entries,
    };
    if overrides.is_empty() {
        return Ok(reading(alone, entries));
    }
    let sets = overrides.iter().map(|o| o.entry.clone());
    let changed: Vec<Entry> = sets
        .clone()
        .filter(|e| e.section == "scene" && matches!(e.key.as_str(), "kind" | "formula"))
        .filter(|e| {
            let (kind, formula) = (alone.scene.kind(), alone.scene.formula());
            let now = if e.key == "kind" { Some(kind) } else { formula };
            e.value.as_str() != now
        })
        .collect();
    if !changed.is_empty() {
        let kind = sets.clone().rfind(|e| e.path() == "scene.kind");
        let formula = kind.is_none_or(|e| e.value.as_str() == Some("distance"));
        let keeps = |e: &Entry| match e.key.as_str() {
            "kind" => true,
            "formula" | "iterations" => formula,
            _ => false,
        };
        entries.retain(|e| e.section != "scene" || keeps(e));
    }
    entries.extend(sets);
    Ok(reading(reader.plan(&entries)?, entries))
}

/// Turns entries into a plan, and names their places in errors.
struct Reader<'a> {
    text: &'a str,
    origin: &'a str,
    folder: &'a Path,
}

impl Reader<'_> {
    fn plan(&self, entries: &[Entry]) -> Result<Plan, PresetError> {
        for entry in entries {
            if !entry.section.is_empty() && !SECTIONS.contains(&entry.section.as_str()) {
                return Err(self.at(entry, unknown_section(&entry.section)));
            }
        }
        let mut plan = Plan::new(self.scene(entries)?);
        for entry in entries {
            self.put(&mut plan, entry)?;
        }
        plan.check()
            .map_err(|fault| self.fault(&mut plan, entries, fault))?;
        Ok(plan)
    }

    /// The scene that `scene.kind` and `scene.formula` choose.
    fn scene(&self, entries: &[Entry]) -> Result<Scene, PresetError> {
        let Some(kind) = last(entries, "kind") else {
            return Err(self.missing("scene.kind is missing; kind = \"distance\" with a formula would do, or kind = \"heightfield\""));
        };
        let word = self.word(kind, &kinds())?;
        if word == "distance" {
            let Some(formula) = last(entries, "formula") else {
                let names = Formula::all();
                let names: Vec<&str> = names.iter().map(|s| s.name()).collect();
                let why = format!("scene.formula is missing; it is one of {}", quoted(&names));
                return Err(self.missing(&why));
            };
            return Ok(self.formula(formula)?.into());
        }
        let mut found = Scene::all().into_iter().find(|s| s.kind() == word);
        if let Some(scene) = &mut found {
            scene.set_folder(self.folder);
        }
        found.ok_or_else(|| self.value(kind, "there is no such kind of scene"))
    }

    /// The formula that an entry names.
    fn formula(&self, entry: &Entry) -> Result<Formula, PresetError> {
        let shapes = Formula::all();
        let names: Vec<&str> = shapes.iter().map(|s| s.name()).collect();
        let name = self.word(entry, &names)?;
        Formula::named(name).ok_or_else(|| self.value(entry, "there is no such formula"))
    }

    /// The word of a few that an entry's value is.
    fn word<'w>(&self, entry: &Entry, words: &[&'w str]) -> Result<&'w str, PresetError> {
        let given = entry.value.as_str();
        if let Some(word) = words.iter().find(|w| given == Some(w)) {
            return Ok(word);
        }
        let near = given.and_then(|g| nearest(g, words.iter().copied()));
        let near = near.map_or(String::new(), |n| format!(", perhaps \"{n}\""));
        let one = format!("must be one of {}", quoted(words));
        Err(self.value(entry, &format!("{one}{near}")))
    }

    /// Puts one entry into the plan.
    fn put(&self, plan: &mut Plan, entry: &Entry) -> Result<(), PresetError> {
        if entry.section.is_empty() {
            let set = text(&mut plan.title).set(&entry.value);
            return set.map_err(|why| self.value(entry, &format!("must be {why}")));
        }
        let (kind, formula) = (plan.scene.kind(), plan.scene.formula());
        if entry.section == "scene" {
            match (entry.key.as_str(), formula) {
                // The last of each has chosen the scene; the others are checked as well.
                ("kind", _) => return self.word(entry, &kinds()).map(|_| ()),
                ("formula", Some(_)) => return self.formula(entry).map(|_| ()),
                ("formula", None) => {
                    let why = format!("a {kind} has no formula; leave it out");
                    return Err(self.value(entry, &why));
                }
                _ => {}
            }
        }
        let mut keys = plan.keys(&entry.section).unwrap_or_default();
        match keys.iter_mut().find(|k| k.name == entry.key) {
            Some(key) => {
                let set = key.slot.set(&entry.value);
                set.map_err(|why| self.value(entry, &format!("must be {why}")))
            }
            None => {
                let of = match entry.section.as_str() {
                    "scene" => format!(" of {}", formula.unwrap_or(kind)),
                    _ => String::new(),
                };
                Err(self.value(entry, &unknown_key(entry, &keys, &of)))
            }
        }
    }

    /// A fault of the whole plan, reported at its key or at the overrides that cause it.
    fn fault(&self, plan: &mut Plan, entries: &[Entry], fault: Fault) -> PresetError {
        let said = entries.iter().rev().find(|e| e.path() == fault.key);
        if let Some(entry) = said
            && matches!(entry.said, Said::Set(_))
        {
            return self.value(entry, &fault.why);
        }
        let now = value_of(plan, &fault.key);
        let sets = overrides_to_blame(entries, &fault.key);
        let what = match said {
            Some(entry) => format!("{} = {}", fault.key, entry.shown),
            None => format!("{} = {now} (the default)", fault.key),
        };
        let line = said.and_then(|e| self.line(e));
        if sets.is_empty() {
            return PresetError::Content {
                origin: self.origin.to_string(),
                line,
                why: format!("{what}: {}", fault.why),
            };
        }
        let place = place(self.origin, line);
        PresetError::Override {
            overrides: sets.join(" "),
            why: format!("{place}: {what}: {}", fault.why),
        }
    }

    fn line(&self, entry: &Entry) -> Option<usize> {
        match entry.said {
            Said::File(at) => Some(line_of(self.text, at)),
            Said::Set(_) => None,
        }
    }

    /// An error about an entry's value.
    fn value(&self, entry: &Entry, why: &str) -> PresetError {
        match entry.said {
            Said::File(_) => {
                let what = format!("{} = {}", brief(&entry.path()), entry.shown);
                self.at(entry, format!("{what}: {why}"))
            }
            // The text of the override names key and value.
            Said::Set(_) => self.at(entry, why.into()),
        }
    }

    fn at(&self, entry: &Entry, why: String) -> PresetError {
        match &entry.said {
            Said::File(_) => PresetError::Content {
                origin: self.origin.to_string(),
                line: self.line(entry),
                why,
            },
            Said::Set(text) => PresetError::Override {
                overrides: text.clone(),
                why,
            },
        }
    }

    fn missing(&self, why: &str) -> PresetError {
        PresetError::Content {
            origin: self.origin.to_string(),
            line: None,
            why: why.into(),
        }
    }
}

/// The last entry of `[scene]` with a key.
fn last<'e>(entries: &'e [Entry], key: &str) -> Option<&'e Entry> {
    let fits = |e: &&Entry| e.section == "scene" && e.key == key;
    entries.iter().rev().find(fits)
}

/// What a plan has at `section.key`.
fn value_of(plan: &mut Plan, path: &str) -> Value {
    let found = path.split_once('.').and_then(|(section, key)| {
        let keys = plan.keys(section)?;
        let key = keys.into_iter().find(|k| k.name == key)?;
        Some(key.slot.get())
    });
    found.unwrap_or_else(|| Value::String(String::new()))
}

/// The overrides in the section of a fault, or all overrides if it has none.
fn overrides_to_blame(entries: &[Entry], path: &str) -> Vec<String> {
    let section = path.split_once('.').map_or("", |(section, _)| section);
    let sets = entries.iter().filter_map(|e| match &e.said {
        Said::Set(text) => Some((e.section.as_str(), text.clone())),
        Said::File(_) => None,
    });
    let (near, far): (Vec<_>, Vec<_>) = sets.partition(|(s, _)| *s == section);
    let blamed = if near.is_empty() { far } else { near };
    blamed.into_iter().map(|(_, text)| text).collect()
}

fn unknown_key(entry: &Entry, keys: &[Key<'_>], of: &str) -> String {
    let mut names: Vec<&str> = keys.iter().map(|k| k.name).collect();
    if entry.section == "scene" {
        // Only a distance scene has `iterations`, beside the keys of its formula.
        let formula = names.contains(&"iterations").then_some("formula");
        names.splice(0..0, ["kind"].into_iter().chain(formula));
    }
    let near = nearest(&entry.key, names.iter().copied());
    let near = near.map_or(String::new(), |n| format!(", perhaps `{n}`"));
    let list = names.join(", ");
    format!("unknown key{near}; [{}]{of} has {list}", entry.section)
}

fn quoted(words: &[&str]) -> String {
    let words: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
    words.join(", ")
}
