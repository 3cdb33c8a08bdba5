//! Writes a plan as the text of a preset: every key, in the order of its lists, and
//! the tracks.

use std::fmt::Write as _;
use std::iter;

use toml::Value;

use crate::plan::Plan;
use crate::preset::document::SECTIONS;
use crate::time::track::TrackKey;

/// The preset of a plan. Reading it gives the same plan, bit for bit.
pub fn write(plan: &Plan) -> String {
    let mut plan = plan.clone();
    let mut text = String::new();
    let (kind, formula) = (plan.scene.kind(), plan.scene.formula());
    for section in iter::once("").chain(SECTIONS) {
        if !section.is_empty() {
            // Writing to a string cannot fail, here and below.
            let _ = writeln!(text, "\n[{section}]");
        }
        if section == "scene" {
            line(&mut text, "kind", &Value::String(kind.into()));
            if let Some(formula) = formula {
                line(&mut text, "formula", &Value::String(formula.into()));
            }
        }
        for key in plan.keys(section).unwrap_or_default() {
            line(&mut text, key.name, &key.slot.get());
        }
    }
    for track in &plan.tracks {
        let _ = writeln!(text, "\n[[track]]");
        line(&mut text, "key", &track.of.clone().into());
        line(&mut text, "between", &track.between.name().into());
        let keys: Vec<Value> = track.keys.iter().map(key).collect();
        line(&mut text, "keys", &keys.into());
    }
    text
}

/// `[time, value]`, perhaps with the way to the next key.
fn key(key: &TrackKey) -> Value {
    let value = match key.value[..] {
        [x] => x.into(),
        _ => key.value.clone().into(),
    };
    let between = key.between.map(|between| between.name().into());
    let parts = [Value::Float(key.time), value].into_iter().chain(between);
    parts.collect::<Vec<_>>().into()
}

fn line(text: &mut String, name: &str, value: &Value) {
    let _ = writeln!(text, "{name} = {value}");
}
