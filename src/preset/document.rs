//! Presets and overrides as flat lists of entries: section, key, value and origin.

use toml::de::{DeString, DeTable, DeValue};
use toml::{Spanned, Value};

use crate::preset::error::PresetError;
use crate::preset::nearest::{nearest, perhaps};

/// The sections of a preset, in the order in which they are written.
pub const SECTIONS: [&str; 6] = ["scene", "camera", "march", "look", "image", "time"];
/// What an entry of a track has as its section. Its key is that of the setting.
pub(crate) const TRACK: &str = "track";
/// What a track is made of.
pub(crate) const TRACK_KEYS: [&str; 3] = ["key", "between", "keys"];

/// Where an entry comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Origin {
    /// At a byte of the preset's text.
    File(usize),
    /// In an override, as it was given.
    Set(String),
}

/// One value of a preset.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// Its section; empty at the top level.
    pub section: String,
    /// Its key.
    pub key: String,
    /// Its value.
    pub value: Value,
    /// The value as it was written, shortened.
    pub shown: String,
    /// Where it comes from.
    pub origin: Origin,
}

impl Entry {
    /// `section.key`, or the key alone at the top level.
    pub fn path(&self) -> String {
        path(&self.section, &self.key)
    }
}

fn path(section: &str, key: &str) -> String {
    match section {
        "" => key.into(),
        _ => format!("{section}.{key}"),
    }
}

/// A value that takes precedence over a preset's: `section.key=value`.
#[derive(Clone, Debug)]
pub struct Override(pub(crate) Entry);

impl Override {
    /// Reads `section.key=value`. Values are TOML. Words like `fbm:64x64,seed=3` or
    /// `maps/d8.png` need no quotes.
    ///
    /// # Errors
    /// The text has another form. Key and value are checked with the preset.
    pub fn read(text: &str) -> Result<Self, PresetError> {
        let fail = |why: String| PresetError::Override {
            overrides: given(text),
            why,
        };
        let form = "write section.key=value, like camera.fov=30";
        let Some((name, value)) = text.split_once('=') else {
            return Err(fail(format!("there is no `=`; {form}")));
        };
        let name = name.trim();
        let (section, key) = match name.split_once('.') {
            Some((section, key)) if !section.is_empty() => (section, key),
            None if name == "title" => ("", name),
            _ => return Err(fail(format!("`{}` names no section; {form}", brief(name)))),
        };
        let value = value.trim();
        let read = match DeValue::parse(value) {
            Ok(read) => convert(read.get_ref()).map_err(fail)?,
            // A title is always text; elsewhere only a word needs no quotes.
            Err(_) if section.is_empty() || bare(value) => Value::String(value.into()),
            Err(e) => {
                let why = sentence(e.message());
                return Err(fail(format!("the value is not TOML: {why}")));
            }
        };
        Ok(Self(Entry {
            section: section.into(),
            key: key.into(),
            value: read,
            shown: brief(value),
            origin: Origin::Set(given(text)),
        }))
    }
}

/// `--set` with its text.
fn given(text: &str) -> String {
    format!("--set {}", brief(text))
}

/// Whether a word needs no quotes: a field with its numbers, or a path.
fn bare(text: &str) -> bool {
    let first = |c: char| c.is_alphanumeric() || matches!(c, '.' | '/');
    let rest = |c: char| c.is_alphanumeric() || "_.:,=/+-#".contains(c);
    text.starts_with(first) && text.chars().all(rest)
}

/// A text on one line, shortened and without control characters, for use in a sentence.
pub(crate) fn brief(text: &str) -> String {
    const MOST: usize = 60;
    // No more words fit.
    let words: Vec<&str> = text.split_whitespace().take(MOST).collect();
    let escaped = |c: char| match c.is_control() {
        true => c.escape_default().to_string(),
        false => c.to_string(),
    };
    let words = words.join(" ");
    let mut line: String = words.chars().take(MOST + 1).map(escaped).collect();
    if line.chars().count() > MOST {
        line = line.chars().take(MOST - 3).chain("...".chars()).collect();
    }
    line
}

/// A message of the TOML parser as a part of a sentence.
fn sentence(message: &str) -> String {
    let lines: Vec<&str> = message.lines().map(str::trim).collect();
    lines.join(", ").trim_end_matches('.').to_string()
}

/// A parsed value without its position in the text.
fn convert(value: &DeValue<'_>) -> Result<Value, String> {
    Ok(match value {
        DeValue::String(s) => Value::String(s.to_string()),
        DeValue::Integer(i) => {
            let read = i64::from_str_radix(i.as_str(), i.radix());
            Value::Integer(read.map_err(|_| format!("{} is too large", brief(i.as_str())))?)
        }
        DeValue::Float(x) => {
            let read = x.as_str().parse();
            Value::Float(read.map_err(|_| format!("{} is no number", brief(x.as_str())))?)
        }
        DeValue::Boolean(b) => Value::Boolean(*b),
        DeValue::Datetime(d) => Value::Datetime(*d),
        DeValue::Array(list) => {
            let items = list.iter().map(|v| convert(v.get_ref()));
            Value::Array(items.collect::<Result<_, _>>()?)
        }
        // No key takes a table: its content does not matter.
        DeValue::Table(_) => Value::Table(toml::Table::new()),
    })
}

/// The line that a byte of a text is in, from 1.
pub(crate) fn line_of(text: &str, at: usize) -> usize {
    let before = &text.as_bytes()[..at.min(text.len())];
    1 + before.iter().filter(|b| **b == b'\n').count()
}

/// The entries of a preset's text, in the order of the text.
pub(crate) fn parse(text: &str, origin: &str) -> Result<Vec<Entry>, PresetError> {
    let content = |at: usize, why: String| PresetError::Content {
        origin: origin.to_string(),
        line: Some(line_of(text, at)),
        why,
    };
    let table = DeTable::parse(text).map_err(|e| {
        let at = e.span().map_or(0, |s| s.start);
        content(at, format!("this is not TOML: {}", sentence(e.message())))
    })?;
    let shown = |value: &Spanned<DeValue<'_>>| brief(text.get(value.span()).unwrap_or_default());
    let entry = |section: &str, key: &Spanned<DeString<'_>>, value: &Spanned<DeValue<'_>>| {
        let (at, shown) = (key.span().start, shown(value));
        let read = convert(value.get_ref()).map_err(|why| {
            let path = brief(&path(section, key.get_ref()));
            content(at, format!("{path} = {shown}: {why}"))
        })?;
        Ok(Entry {
            section: section.into(),
            key: key.get_ref().to_string(),
            value: read,
            shown,
            origin: Origin::File(at),
        })
    };
    let mut entries = Vec::new();
    for (key, value) in table.get_ref() {
        let (at, name): (usize, &str) = (key.span().start, key.get_ref());
        if name == "title" {
            entries.push(entry("", key, value)?);
        } else if name == TRACK {
            let DeValue::Array(tracks) = value.get_ref() else {
                return Err(content(at, "a track is written [[track]]".into()));
            };
            for track in tracks {
                let at = track.span().start;
                let read = track_of(track.get_ref()).map_err(|why| content(at, why))?;
                entries.push(Entry {
                    origin: Origin::File(at),
                    ..read
                });
            }
        } else if !SECTIONS.contains(&name) {
            return Err(content(at, unknown_section(name)));
        } else if let DeValue::Table(section) = value.get_ref() {
            for (key, value) in section {
                entries.push(entry(name, key, value)?);
            }
        } else {
            let shown = shown(value);
            let why = format!("{name} = {shown}: must be a section, like [{name}]");
            return Err(content(at, why));
        }
    }
    entries.sort_by_key(|e| match e.origin {
        Origin::File(at) => at,
        Origin::Set(_) => usize::MAX,
    });
    Ok(entries)
}

/// The entry of a track: its key is that of the setting, and its value holds the rest.
fn track_of(track: &DeValue<'_>) -> Result<Entry, String> {
    let form =
        "a track has key = \"section.key\", keys = [[time, value], ...], and perhaps between";
    let DeValue::Table(table) = track else {
        return Err(form.into());
    };
    let mut rest = toml::Table::new();
    for (name, value) in table {
        let name: &str = name.get_ref();
        if !TRACK_KEYS.contains(&name) {
            let near = perhaps(nearest(name, TRACK_KEYS));
            return Err(format!(
                "unknown key `{}` of a track{near}; {form}",
                brief(name)
            ));
        }
        rest.insert(name.into(), convert(value.get_ref())?);
    }
    let key = rest.remove("key");
    let key = key.as_ref().and_then(Value::as_str).ok_or(form)?;
    let shown = rest.get("keys").map(|keys| brief(&keys.to_string()));
    Ok(Entry {
        section: TRACK.into(),
        key: key.into(),
        shown: shown.ok_or(form)?,
        value: Value::Table(rest),
        origin: Origin::File(0),
    })
}

/// Says that a section does not exist, and which one may have been meant.
pub(crate) fn unknown_section(name: &str) -> String {
    let there = format!(
        "the sections are {} and [[track]], and title stands above them",
        SECTIONS.join(", ")
    );
    let near = perhaps(nearest(name, SECTIONS.into_iter().chain(["title"])));
    format!("unknown section `{}`{near}; {there}", brief(name))
}
