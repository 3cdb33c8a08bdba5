//! One row of `bench error`: a preset and a setting with their work, time and error.
//!
//! A footprint is half a pixel's width at the distance of the hit.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::measure::compare::Report;
use crate::measure::sharpness::Sharpness;
use crate::measure::truth::TruthNote;

/// A measured setting. Shares are of all pixels, 0..1; errors in footprints.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Row {
    /// Name of the preset.
    pub preset: String,
    /// Mode of the march.
    pub mode: String,
    /// Keys of `[march]` that differ from the preset's.
    pub parameters: Map<String, Value>,
    /// Whether nothing but the mode differs, or it is a rival.
    pub baseline: bool,
    /// Pixels along each axis.
    pub size: [u32; 2],
    /// Who rendered.
    pub device: String,
    /// March and trace on the clock, median of warm runs.
    pub wall_ms: f64,
    /// March and trace on the device, where it has timestamps.
    pub gpu_ms: Option<f64>,
    /// Estimate evaluations of march and trace over pixels.
    pub evaluations_per_pixel: f64,
    /// Fold iterations of march and trace over pixels.
    pub iterations_per_pixel: f64,
    /// How the depths and states differ from the truth's.
    #[serde(flatten)]
    pub report: Report,
    /// Mean FLIP difference of the pictures.
    pub flip: f64,
    /// How far it is from the set.
    #[serde(flatten)]
    pub sharpness: Sharpness,
    /// How converged the truth is.
    pub truth: TruthNote,
    /// A warning if f32 is not precise enough for the preset.
    pub precision: Option<String>,
}

impl Row {
    /// Whether the row is compared with the usual truth: another `detail` or estimate has another one.
    pub fn is_comparable(&self) -> bool {
        !["detail", "estimate"]
            .map(|key| self.parameters.contains_key(key))
            .contains(&true)
    }

    /// The mode, or `rival` for `ray-relaxed` with `clip` on, or `old rival` with another estimate.
    pub fn name(&self) -> &str {
        let is_clipped = self.parameters.get("clip").is_some_and(|v| v == "on");
        match self.mode.as_str() {
            "ray-relaxed" if is_clipped && !self.is_comparable() => "old rival",
            "ray-relaxed" if is_clipped => "rival",
            mode => mode,
        }
    }

    /// The mode and the keys that differ, like `safe, shell 0.1`; or `rival`, or `old rival`.
    pub fn label(&self) -> String {
        if self.name().ends_with("rival") {
            return self.name().into();
        }
        let word = |(key, value): (&String, &Value)| match value {
            Value::String(text) => format!(", {key} {text}"),
            other => format!(", {key} {other}"),
        };
        let more: String = self.parameters.iter().map(word).collect();
        format!("{}{more}", self.mode)
    }
}

/// A row as names and values, for CSV. Objects other than `parameters` become a column for
/// each field.
pub fn flat<R: Serialize>(row: &R) -> Vec<(String, String)> {
    let mut flat = Vec::new();
    let whole = serde_json::to_value(row).unwrap_or_default();
    for (name, value) in whole.as_object().into_iter().flatten() {
        match value {
            Value::Object(parts) if name != "parameters" => {
                for (part, value) in parts {
                    flat.push((format!("{name}_{part}"), plain(value)));
                }
            }
            _ => flat.push((name.clone(), plain(value))),
        }
    }
    flat
}

/// A value as a cell: text without quotes, nothing for null, lists with blanks.
fn plain(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(items) => items.iter().map(plain).collect::<Vec<_>>().join(" "),
        other => other.to_string(),
    }
}
