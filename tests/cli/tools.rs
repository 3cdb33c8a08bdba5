//! What the modules share: arguments as one text, tiny renders, and decoded pictures.

use serde_json::Value;

use crate::folder::{Folder, said};

/// The arguments of a tiny render by the CPU executor.
pub fn tiny(preset: &str, more: &str) -> String {
    format!("render {preset} --device cpu --size 24x16 {more}")
}

/// Renders a tiny picture, and returns what was said on standard error.
pub fn rendered(folder: &Folder, preset: &str, more: &str) -> String {
    said(&folder.done(&tiny(preset, more)))
}

/// A JSON file or text.
pub fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).expect("JSON")
}

/// The names of the fields of a JSON object, in order.
pub fn names(row: &Value) -> Vec<&str> {
    row.as_object()
        .expect("an object")
        .keys()
        .map(String::as_str)
        .collect()
}

/// The number of a field.
pub fn number(row: &Value, field: &str) -> f64 {
    row[field].as_f64().expect(field)
}
