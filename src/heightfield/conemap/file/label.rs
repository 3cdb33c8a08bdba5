//! The text in a file that says what its cones are and which heights they belong to:
//! TOML, in a text chunk of a PNG (keyword `conemarch cone map`) or an attribute of an
//! EXR of that name.

use serde::{Deserialize, Serialize};

use crate::heightfield::conemap::file::map_file::scale;
use crate::heightfield::conemap::file::{
    Channel, Label, Layout, MapFile, MapFormat, RatioScale, Slopes,
};
use crate::heightfield::conemap::generate::generator::{LEAST_OFFSET, MOST_OFFSET};
use crate::heightfield::heights::{MOST_SAMPLES, wrap_name, wrap_named};
use crate::heightfield::{ConeMap, MapKind, Patches};

/// Keyword of the text chunk and name of the attribute.
pub(crate) const KEYWORD: &str = "conemarch cone map";

/// The text as it stands in a file.
#[derive(Debug, Serialize, Deserialize)]
struct Text {
    /// Of the text itself.
    version: u32,
    kind: String,
    layout: String,
    /// `linear` or `sqrt`.
    ratio: String,
    /// Texels that a ratio of 1 means.
    scale: f64,
    wrap: String,
    /// Texels of room that a walk's cones leave.
    offset: f64,
    samples: [u32; 2],
    /// `bilinear` or `boxes`.
    surface: String,
    /// `linear` or `sqrt`: whole numbers that the ratios of an EXR were read from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    from_ratio: Option<String>,
    /// `whole` or `half`, where the layout has slopes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    slopes: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    heights_sha256: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    generator: Option<String>,
}

/// The only version of the text so far.
const VERSION: u32 = 1;

/// Writes the text for a map in a format.
pub(crate) fn write(file: &MapFile, format: &MapFormat) -> Result<String, String> {
    let map = &file.map;
    let label = &file.label;
    // The numbers of a PNG are their own origin.
    let origin = file.origin.filter(|_| format.layout.is_exr());
    let has_slopes = format.layout.has(Channel::SlopeX);
    let text = Text {
        version: VERSION,
        kind: map.kind.name().into(),
        layout: format.layout.name().into(),
        ratio: format.ratio.name().into(),
        scale: label.scale,
        wrap: wrap_name(map.wrap).into(),
        offset: map.offset,
        samples: label.samples,
        surface: label.patches.name().into(),
        from_ratio: origin.map(|origin| origin.name().into()),
        slopes: has_slopes.then(|| format.slopes.name().into()),
        heights_sha256: label.digest.clone(),
        generator: label.generator.clone(),
    };
    toml::to_string(&text).map_err(|e| e.to_string())
}

fn broken(why: &str) -> String {
    format!("has a label that cannot be understood ({why}); make the map again")
}

fn wrong(key: &str, value: &str) -> String {
    broken(&format!("{key} = {value}"))
}

/// The value of a word under a key.
fn word<T>(key: &str, word: &str, named: impl Fn(&str) -> Option<T>) -> Result<T, String> {
    named(word).ok_or_else(|| wrong(key, word))
}

/// Reads a text: a map that still lacks its numbers.
///
/// # Errors
/// In words: the text is not a label, or contradicts itself.
pub(crate) fn read(text: &str) -> Result<MapFile, String> {
    let text: Text = toml::from_str(text).map_err(|e| broken(e.message()))?;
    if text.version != VERSION {
        return Err(format!(
            "was written by a later conemarch (its label has version {}, and only {VERSION} is known); make the map again",
            text.version
        ));
    }
    let kind = word("kind", &text.kind, MapKind::named)?;
    let layout = word("layout", &text.layout, Layout::named)?;
    let wrap = word("wrap", &text.wrap, wrap_named)?;
    let ratio = word("ratio", &text.ratio, RatioScale::named)?;
    let origin = text.from_ratio.as_deref();
    let origin = origin.map(|w| word("from_ratio", w, RatioScale::named));
    let origin = origin.transpose()?;
    let patches = word("surface", &text.surface, Patches::named)?;
    let slopes = text.slopes.as_deref().unwrap_or(Slopes::Whole.name());
    let slopes = word("slopes", slopes, Slopes::named)?;
    if layout.lacks(kind).is_some() {
        let both = format!("{} in the layout {}", text.kind, text.layout);
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
    if origin.is_some() && !layout.is_exr() {
        return Err(wrong("from_ratio", "for a layout of numbers"));
    }
    if text.samples.iter().any(|n| !(1..=MOST_SAMPLES).contains(n)) {
        return Err(wrong("samples", &format!("{:?}", text.samples)));
    }
    // Only this scale is ever written. Another one would make all cones wider or narrower.
    if text.scale != scale(text.samples) {
        return Err(wrong("scale", &text.scale.to_string()));
    }
    let map = ConeMap {
        kind,
        size: kind.places(text.samples, wrap, patches),
        wrap,
        offset: text.offset,
        ratios: Vec::new(),
    };
    let format = MapFormat {
        ratio,
        slopes,
        ..MapFormat::new(layout)
    };
    let label = Label {
        samples: text.samples,
        patches,
        scale: text.scale,
        digest: text.heights_sha256,
        generator: text.generator,
    };
    Ok(MapFile {
        origin,
        ..MapFile::bare(map, format, label)
    })
}
