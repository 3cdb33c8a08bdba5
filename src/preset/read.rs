//! Reads the text of a preset and its overrides into a plan, and checks every value.

use std::path::PathBuf;

use toml::Value;

use crate::base::key::{Fault, Key, number_in};
use crate::plan::Plan;
use crate::plan::film::numbers_of;
use crate::preset::document::{
    Entry, Origin, Override, SECTIONS, TRACK, brief, line_of, parse, unknown_section,
};
use crate::preset::error::PresetError;
use crate::preset::keys::{keys, words};
use crate::preset::nearest::{nearest, perhaps};
use crate::preset::source::Source;
use crate::scene::{Assets, Scene};
use crate::time::track::{Between, Track, TrackKey};

/// Words for `scene.kind`.
pub(super) fn kinds() -> Vec<&'static str> {
    let mut kinds: Vec<&str> = Scene::all().iter().map(|s| s.kind()).collect();
    // One distance scene for each formula.
    kinds.dedup();
    kinds
}

/// Words for `scene.formula`.
fn formulas() -> Vec<&'static str> {
    let scenes = Scene::all();
    scenes.iter().filter_map(|s| s.formula()).collect()
}

/// A preset that was found and read.
#[derive(Clone, Debug)]
pub struct Preset {
    /// As [`Source::name`].
    pub name: String,
    /// The plan.
    pub plan: Plan,
    source: Source,
    entries: Vec<Entry>,
}

impl Preset {
    /// Reads a preset from its text. Errors name it as `origin`; files that it names are relative
    /// to the current folder. It must also be valid without the overrides.
    ///
    /// An override of `scene.kind` or `scene.formula` that changes it drops the preset's
    /// other values of the scene: they belong to another one.
    ///
    /// # Errors
    /// Wrong syntax, unknown names, wrong types, impossible values. The error names file, line,
    /// key, value and a valid alternative. Faults that only the overrides cause are reported at
    /// the overrides.
    pub fn read(text: &str, origin: &str, overrides: &[Override]) -> Result<Self, PresetError> {
        let source = Source {
            name: origin.into(),
            text: text.into(),
            origin: origin.into(),
            folder: PathBuf::new(),
        };
        source.read(overrides)
    }

    /// Its text, without overrides.
    pub fn text(&self) -> &str {
        &self.source.text
    }

    /// Reads the files that the preset names, and keeps them in the assets.
    ///
    /// # Errors
    /// A file cannot be read, holds something else or does not fit. The error names the line
    /// of the preset, or the override.
    pub fn load_assets(&self, assets: &Assets) -> Result<(), PresetError> {
        let loaded = assets.load(&self.plan);
        loaded.map_err(|fault| self.source.fault(&self.plan, &self.entries, fault))
    }
}

/// The word that an entry's value probably means, in the middle of a sentence, or nothing.
fn near<'a>(entry: &Entry, words: impl Iterator<Item = &'a str>) -> String {
    let near = entry.value.as_str().and_then(|given| nearest(given, words));
    near.map_or(String::new(), |near| format!(", perhaps \"{near}\""))
}

/// The plan of a preset's text; see [`Preset::read`].
///
/// # Errors
/// As [`Preset::read`].
pub fn read(text: &str, origin: &str) -> Result<Plan, PresetError> {
    Ok(Preset::read(text, origin, &[])?.plan)
}

impl Source {
    pub(super) fn read(self, overrides: &[Override]) -> Result<Preset, PresetError> {
        let mut entries = parse(&self.text, &self.origin)?;
        let mut plan = self.plan(&entries)?;
        if !overrides.is_empty() {
            let sets: Vec<Entry> = overrides.iter().map(|o| o.0.clone()).collect();
            let changes = |e: &Entry| match e.path().as_str() {
                "scene.kind" => e.value.as_str() != Some(plan.scene.kind()),
                "scene.formula" => e.value.as_str() != plan.scene.formula(),
                _ => false,
            };
            if sets.iter().any(changes) {
                let kind = last(&sets, "kind");
                let formula = kind.is_none_or(|e| e.value.as_str() == Some("distance"));
                let keeps = |e: &Entry| match e.key.as_str() {
                    "kind" => true,
                    "formula" | "iterations" => formula,
                    _ => false,
                };
                let is_of_scene = |e: &Entry| e.section == TRACK && e.key.starts_with("scene.");
                entries.retain(|e| (e.section != "scene" || keeps(e)) && !is_of_scene(e));
            }
            entries.extend(sets);
            plan = self.plan(&entries)?;
        }
        Ok(Preset {
            name: self.name.clone(),
            plan,
            source: self,
            entries,
        })
    }

    fn plan(&self, entries: &[Entry]) -> Result<Plan, PresetError> {
        for entry in entries {
            let is_track = entry.section == TRACK && matches!(entry.origin, Origin::File(_));
            let known = entry.section.is_empty() || SECTIONS.contains(&entry.section.as_str());
            if !known && !is_track {
                return Err(self.at(entry, unknown_section(&entry.section)));
            }
        }
        let mut plan = Plan::new(self.scene(entries)?);
        plan.set_folder(&self.folder);
        for entry in entries {
            self.put(&mut plan, entry)?;
        }
        let checked = plan.check();
        checked.map_err(|fault| self.fault(&plan, entries, fault))?;
        Ok(plan)
    }

    /// The scene that `scene.kind` and `scene.formula` choose.
    fn scene(&self, entries: &[Entry]) -> Result<Scene, PresetError> {
        let Some(kind) = last(entries, "kind") else {
            let why = format!("scene.kind is missing; it is one of {}", quoted(&kinds()));
            return Err(self.content(None, why));
        };
        let word = self.word(kind, &kinds())?;
        let formula = match last(entries, "formula") {
            _ if word != "distance" => None,
            Some(formula) => Some(self.word(formula, &formulas())?),
            None => {
                let names = quoted(&formulas());
                let why = format!("scene.formula is missing; it is one of {names}");
                return Err(self.content(None, why));
            }
        };
        let mut scenes = Scene::all().into_iter();
        let found = scenes.find(|s| s.kind() == word && s.formula() == formula);
        found.ok_or_else(|| self.value(kind, "there is no such kind of scene"))
    }

    /// The word of a few that an entry's value is.
    fn word<'w>(&self, entry: &Entry, words: &[&'w str]) -> Result<&'w str, PresetError> {
        let given = entry.value.as_str();
        if let Some(word) = words.iter().find(|w| given == Some(w)) {
            return Ok(word);
        }
        let near = near(entry, words.iter().copied());
        let one = format!("must be one of {}", quoted(words));
        Err(self.value(entry, &format!("{one}{near}")))
    }

    /// Puts one entry into the plan.
    fn put(&self, plan: &mut Plan, entry: &Entry) -> Result<(), PresetError> {
        if entry.section == TRACK {
            if plan.value(&entry.key).is_none() {
                let known = keys()
                    .into_iter()
                    .map(|(path, ..)| path)
                    .collect::<Vec<_>>();
                let key = brief(&entry.key);
                let why = match &*entry.key {
                    "scene.kind" | "scene.formula" => {
                        format!("a track cannot change {key}; a film has one scene")
                    }
                    other if known.iter().any(|path| path == other) => {
                        format!("the plan has no key `{key}`; it is one of another kind of scene")
                    }
                    other => {
                        let near = perhaps(nearest(other, known.iter().map(String::as_str)));
                        format!("the plan has no key `{key}`{near}")
                    }
                };
                return Err(self.at(entry, format!("track: {why}")));
            }
            let track = track(entry).map_err(|why| self.value(entry, &why))?;
            plan.tracks.push(track);
            return Ok(());
        }
        let (kind, formula) = (plan.scene.kind(), plan.scene.formula());
        match (entry.path().as_str(), formula) {
            // The last of each has chosen the scene; the others are checked as well.
            ("scene.kind", _) => return self.word(entry, &kinds()).map(|_| ()),
            ("scene.formula", Some(_)) => return self.word(entry, &formulas()).map(|_| ()),
            ("scene.formula", None) => {
                let why = format!("a {kind} has no formula; leave it out");
                return Err(self.value(entry, &why));
            }
            _ => {}
        }
        let mut keys = plan.keys(&entry.section).unwrap_or_default();
        let Some(key) = keys.iter_mut().find(|k| k.name == entry.key) else {
            let of = match entry.section.as_str() {
                "scene" => format!(" of {}", formula.unwrap_or(kind)),
                _ => String::new(),
            };
            return Err(self.value(entry, &unknown_key(entry, &keys, &of)));
        };
        let set = key.slot.set(&entry.value);
        set.map_err(|why| {
            let words = words(&why);
            let near = near(entry, words.iter().map(String::as_str));
            self.value(entry, &format!("must be {why}{near}"))
        })
    }

    /// A fault of the whole plan, reported at its key or at the overrides that cause it.
    fn fault(&self, plan: &Plan, entries: &[Entry], fault: Fault) -> PresetError {
        let said = entries.iter().rfind(|e| e.path() == fault.key);
        let what = match said {
            Some(entry) if matches!(entry.origin, Origin::Set(_)) => {
                return self.value(entry, &fault.why);
            }
            Some(entry) => format!("{} = {}", fault.key, entry.shown),
            None => format!(
                "{} = {} (the default)",
                fault.key,
                plan.value(&fault.key).unwrap_or("".into())
            ),
        };
        let line = said.and_then(|e| self.line(e));
        let error = self.content(line, format!("{what}: {}", fault.why));
        match overrides_to_blame(entries, &fault.key) {
            sets if sets.is_empty() => error,
            sets => PresetError::Override {
                overrides: sets.join(" "),
                why: error.to_string(),
            },
        }
    }

    fn line(&self, entry: &Entry) -> Option<usize> {
        match entry.origin {
            Origin::File(at) => Some(line_of(&self.text, at)),
            Origin::Set(_) => None,
        }
    }

    /// An error about an entry's value.
    fn value(&self, entry: &Entry, why: &str) -> PresetError {
        match entry.origin {
            Origin::File(_) => {
                let what = format!("{} = {}", brief(&entry.path()), entry.shown);
                self.at(entry, format!("{what}: {why}"))
            }
            // The text of the override names key and value.
            Origin::Set(_) => self.at(entry, why.into()),
        }
    }

    fn at(&self, entry: &Entry, why: String) -> PresetError {
        match &entry.origin {
            Origin::File(_) => self.content(self.line(entry), why),
            Origin::Set(text) => PresetError::Override {
                overrides: text.clone(),
                why,
            },
        }
    }

    fn content(&self, line: Option<usize>, why: String) -> PresetError {
        PresetError::Content {
            origin: self.origin.clone(),
            line,
            why,
        }
    }
}

/// The track of an entry.
fn track(entry: &Entry) -> Result<Track, String> {
    let words = || quoted(&Between::ALL.map(Between::name));
    let between = |value: Option<&Value>| match value {
        None => Ok(None),
        Some(word) => match word.as_str().and_then(Between::named) {
            None => Err(format!("between {word}: must be one of {}", words())),
            found => Ok(found),
        },
    };
    let form = "must be a list of [time, value] or [time, value, between], like [[0, 40], [4, 60, \"linear\"]]";
    let key = |key: &Value| {
        let parts = key.as_array().map(Vec::as_slice);
        let (time, value, after) = match parts {
            Some([time, value]) => (time, value, None),
            Some([time, value, after]) => (time, value, Some(after)),
            _ => return Err(form.to_string()),
        };
        Ok(TrackKey {
            time: number_in(time, 0.0, 1e6).ok_or(form)?,
            value: numbers_of(value).ok_or(form)?,
            between: between(after)?,
        })
    };
    let keys = entry.value.get("keys").and_then(Value::as_array);
    Ok(Track {
        of: entry.key.clone(),
        between: between(entry.value.get("between"))?.unwrap_or_default(),
        keys: keys
            .ok_or(form)?
            .iter()
            .map(key)
            .collect::<Result<_, _>>()?,
    })
}

/// The last entry of `[scene]` with a key.
fn last<'e>(entries: &'e [Entry], key: &str) -> Option<&'e Entry> {
    let mut entries = entries.iter();
    entries.rfind(|e| e.section == "scene" && e.key == key)
}

/// The overrides in the section of a fault, or all overrides if it has none.
fn overrides_to_blame(entries: &[Entry], path: &str) -> Vec<String> {
    let section = path.split_once('.').map_or("", |(section, _)| section);
    let sets = entries.iter().filter_map(|e| match &e.origin {
        Origin::Set(text) => Some((e.section.as_str(), text.clone())),
        Origin::File(_) => None,
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
    let near = perhaps(nearest(&entry.key, names.iter().copied()));
    let list = names.join(", ");
    format!("unknown key{near}; [{}]{of} has {list}", entry.section)
}

fn quoted(words: &[&str]) -> String {
    let words: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
    words.join(", ")
}
