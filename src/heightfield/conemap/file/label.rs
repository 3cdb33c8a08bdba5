//! The text in a file that says what its cones are and which heights they belong to:
//! TOML, in a text chunk of a PNG (keyword `conemarch cone map`) or an attribute of an
//! EXR of that name.

use serde::{Deserialize, Serialize};

use crate::heightfield::conemap::MapKind;
use crate::heightfield::conemap::file::form::{Form, Label, Layout, MapFile, Slopes, scale};
use crate::heightfield::conemap::file::words::{
    is_walk, kind_named, kind_word, wrap_named, wrap_word,
};
use crate::heightfield::conemap::generate::generator::{LEAST_OFFSET, MOST_OFFSET};
use crate::heightfield::heights::{MOST_SAMPLES, Patches};

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

fn root_word(root: bool) -> &'static str {
    if root { "sqrt" } else { "linear" }
}

fn root_named(word: &str) -> Option<bool> {
    [true, false]
        .into_iter()
        .find(|root| root_word(*root) == word)
}

/// The only version of the text so far.
const VERSION: u32 = 1;

/// Writes the text for a map in a form.
pub(crate) fn write(file: &MapFile, form: &Form) -> Result<String, String> {
    let map = &file.map;
    let label = &file.label;
    // A PNG says it by its own numbers.
    let origin = file.origin.filter(|_| form.layout == Layout::Full);
    let text = Text {
        version: VERSION,
        kind: kind_word(map.kind).into(),
        layout: form.layout.name().into(),
        ratio: root_word(form.root).into(),
        scale: label.scale,
        wrap: wrap_word(map.wrap).into(),
        offset: map.offset,
        samples: label.samples,
        surface: label.patches.name().into(),
        from_ratio: origin.map(|root| root_word(root).into()),
        slopes: (form.layout == Layout::Dummer).then(|| form.slopes.name().into()),
        heights_sha256: label.digest.clone(),
        generator: label.generator.clone(),
    };
    toml::to_string(&text).map_err(|e| e.to_string())
}

/// What a text says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Read {
    pub kind: MapKind,
    pub layout: Layout,
    pub root: bool,
    pub wrap: [bool; 2],
    pub offset: f64,
    pub slopes: Slopes,
    pub origin: Option<bool>,
    pub label: Label,
}

impl Read {
    /// Places that a map of such heights has along each axis.
    pub fn places(&self) -> [u32; 2] {
        places(self.label.samples, self.wrap, self.kind, self.label.patches)
    }
}

/// Places of a map along each axis: samples, or for walks cells.
pub(crate) fn places(
    samples: [u32; 2],
    wrap: [bool; 2],
    kind: MapKind,
    patches: Patches,
) -> [u32; 2] {
    [0, 1].map(|a| {
        let ends = is_walk(kind) && patches == Patches::Bilinear && !wrap[a];
        samples[a] - u32::from(ends && samples[a] > 1)
    })
}

/// Reads a text.
///
/// # Errors
/// In words: it is none, or says what cannot be.
pub(crate) fn read(text: &str) -> Result<Read, String> {
    let broken = |why: String| {
        format!("says of its cones what is not understood ({why}); make the map again")
    };
    let text: Text = toml::from_str(text).map_err(|e| broken(e.message().to_string()))?;
    if text.version != VERSION {
        return Err(format!(
            "was written by a later conemarch (version {} of its label, and {VERSION} is known); make the map again",
            text.version
        ));
    }
    let wrong = |key: &str, value: &str| broken(format!("{key} = {value}"));
    let kind = kind_named(&text.kind).ok_or_else(|| wrong("kind", &text.kind))?;
    let layout = Layout::named(&text.layout).ok_or_else(|| wrong("layout", &text.layout))?;
    let wrap = wrap_named(&text.wrap).ok_or_else(|| wrong("wrap", &text.wrap))?;
    let root = root_named(&text.ratio).ok_or_else(|| wrong("ratio", &text.ratio))?;
    let origin = match text.from_ratio.as_deref() {
        None => None,
        Some(word) => Some(root_named(word).ok_or_else(|| wrong("from_ratio", word))?),
    };
    let patches = match text.surface.as_str() {
        "bilinear" => Patches::Bilinear,
        "boxes" => Patches::Boxes,
        other => return Err(wrong("surface", other)),
    };
    let slopes = match text.slopes.as_deref() {
        None => Slopes::Whole,
        Some(word) => Slopes::named(word).ok_or_else(|| wrong("slopes", word))?,
    };
    if layout.lacks(kind).is_some() {
        let both = format!("{} in the layout {}", text.kind, text.layout);
        return Err(wrong("kind", &both));
    }
    let room = if is_walk(kind) {
        (LEAST_OFFSET..=MOST_OFFSET).contains(&text.offset)
    } else {
        text.offset == 0.0
    };
    if !room {
        return Err(wrong("offset", &text.offset.to_string()));
    }
    if text.slopes.is_some() && layout != Layout::Dummer {
        return Err(wrong("slopes", "for a layout without"));
    }
    if origin.is_some() && layout != Layout::Full {
        return Err(wrong("from_ratio", "for a layout of numbers"));
    }
    if text.samples.iter().any(|n| !(1..=MOST_SAMPLES).contains(n)) {
        return Err(wrong("samples", &format!("{:?}", text.samples)));
    }
    // Nothing else was ever written; another one would make all cones wider or narrower.
    if text.scale != scale(text.samples) {
        return Err(wrong("scale", &text.scale.to_string()));
    }
    Ok(Read {
        kind,
        layout,
        root,
        wrap,
        offset: text.offset,
        slopes,
        origin,
        label: Label {
            samples: text.samples,
            patches,
            scale: text.scale,
            digest: text.heights_sha256,
            generator: text.generator,
        },
    })
}
