//! The text in a file that says what its cones are and which heights they belong to:
//! TOML, in a text chunk of a PNG (keyword `conemarch cone map`) or an attribute of an
//! EXR of that name.

use serde::{Deserialize, Serialize};

use crate::heightfield::conemap::file::{
    Channel, Label, Layout, MapFile, MapFormat, RatioScale, Slopes,
};
use crate::heightfield::conemap::generate::generator::{LEAST_OFFSET, MOST_OFFSET};
use crate::heightfield::heights::{MOST_SAMPLES, wrap_name, wrap_named};
use crate::heightfield::{ConeMap, MapKind};

/// Keyword of the text chunk and name of the attribute.
pub(crate) const KEYWORD: &str = "conemarch cone map";

/// The text as it stands in a file.
#[derive(Debug, Serialize, Deserialize)]
struct Text {
    /// Of the text itself.
    version: u32,
    kind: MapKind,
    layout: Layout,
    ratio: RatioScale,
    /// Texels that a ratio of 1 means.
    scale: f64,
    wrap: String,
    /// Texels of room that a walk's cones leave.
    offset: f64,
    /// The whole numbers that the ratios of an EXR were read from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    from_ratio: Option<RatioScale>,
    /// Where the layout has slopes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    slopes: Option<Slopes>,
    #[serde(flatten)]
    label: Label,
}

/// What is read first: a later version may have other words.
#[derive(Deserialize)]
struct Version {
    version: u32,
}

/// The only version of the text so far.
const VERSION: u32 = 1;

/// Writes the text for a map in a format.
pub(crate) fn write(file: &MapFile, format: &MapFormat) -> Result<String, String> {
    let map = &file.map;
    let has_slopes = format.layout.has(Channel::SlopeX);
    let text = Text {
        version: VERSION,
        kind: map.kind,
        layout: format.layout,
        ratio: format.ratio,
        scale: file.label.scale(),
        wrap: wrap_name(map.wrap).into(),
        offset: map.offset,
        // The numbers of a PNG are their own origin.
        from_ratio: file.origin.filter(|_| format.layout.is_exr()),
        slopes: has_slopes.then_some(format.slopes),
        label: file.label.clone(),
    };
    toml::to_string(&text).map_err(|e| e.to_string())
}

fn broken(why: &str) -> String {
    format!("has a label that cannot be understood ({why}); make the map again")
}

fn wrong(key: &str, value: &str) -> String {
    broken(&format!("{key} = {value}"))
}

/// Reads a text: a map that still lacks its numbers.
///
/// # Errors
/// In words: the text is not a label, or contradicts itself.
pub(crate) fn read(text: &str) -> Result<MapFile, String> {
    let Version { version } = toml::from_str(text).map_err(|e| broken(e.message()))?;
    if version != VERSION {
        return Err(format!(
            "was written by a later conemarch (its label has version {version}, and only {VERSION} is known); make the map again"
        ));
    }
    let text: Text = toml::from_str(text).map_err(|e| {
        let end = e.span().filter(|s| s.start > 0).map_or(0, |s| s.end);
        let line = text[..end].lines().next_back().unwrap_or_default();
        // What is missing is on no line.
        broken(format!("{line}: {}", e.message()).trim_start_matches(": "))
    })?;
    let Text {
        kind,
        layout,
        label,
        ..
    } = text;
    let wrap = wrap_named(&text.wrap).ok_or_else(|| wrong("wrap", &text.wrap))?;
    if layout.lacks(kind).is_some() {
        let both = format!("{} in the layout {}", kind.name(), layout.name());
        return Err(wrong("kind", &both));
    }
    let room = if kind.over_cells() {
        (LEAST_OFFSET..=MOST_OFFSET).contains(&text.offset)
    } else {
        text.offset == 0.0
    };
    if !room {
        return Err(wrong("offset", &text.offset.to_string()));
    }
    if text.slopes.is_some() && !layout.has(Channel::SlopeX) {
        return Err(wrong("slopes", "for a layout without"));
    }
    if text.from_ratio.is_some() && !layout.is_exr() {
        return Err(wrong("from_ratio", "for a layout of numbers"));
    }
    let samples = label.samples;
    if samples.iter().any(|n| !(1..=MOST_SAMPLES).contains(n)) {
        return Err(wrong("samples", &format!("{samples:?}")));
    }
    // Only this scale is ever written. Another one would make all cones wider or narrower.
    if text.scale != label.scale() {
        return Err(wrong("scale", &text.scale.to_string()));
    }
    let map = ConeMap {
        kind,
        size: kind.places(samples, wrap, label.patches),
        wrap,
        offset: text.offset,
        ratios: Vec::new(),
    };
    let format = MapFormat {
        ratio: text.ratio,
        slopes: text.slopes.unwrap_or(Slopes::Whole),
        ..MapFormat::new(layout)
    };
    Ok(MapFile {
        origin: text.from_ratio,
        ..MapFile::bare(map, format, label)
    })
}
