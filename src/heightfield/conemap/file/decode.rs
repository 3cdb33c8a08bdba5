//! A file to a cone map.
//!
//! A file of another program has no label; what it is must be said then ([`Foreign`]),
//! and is believed. Its ratios may have been rounded up by it.

use std::io::{BufRead, Cursor, Seek};
use std::path::Path;

use crate::heightfield::conemap::file::encode::SIDES;
use crate::heightfield::conemap::file::error::MapError;
use crate::heightfield::conemap::file::form::{
    Bits, Extra, Form, Label, Layout, MapFile, Slopes, scale,
};
use crate::heightfield::conemap::file::label::{self, KEYWORD, Read};
use crate::heightfield::conemap::file::round::Ratios;
use crate::heightfield::conemap::file::words::{is_walk, ratios_per_place};
use crate::heightfield::conemap::{ConeMap, MapKind, WIDEST};
use crate::heightfield::heights::Patches;
use crate::heightfield::raster::open::{Format, format_of, open};
use crate::heightfield::raster::{exr, png};

/// What a file without a label is to be taken for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foreign {
    /// Its channels; not [`Layout::Full`].
    pub layout: Layout,
    /// What its cones promise; not a walk, whose offset and cells nobody else has.
    pub kind: MapKind,
    /// Whether its ratios are square roots.
    pub root: bool,
    /// Which axes wrap.
    pub wrap: [bool; 2],
}

/// Whether a file is a cone map of this program.
///
/// # Errors
/// The file cannot be read at all.
pub fn has_map(path: &Path) -> Result<bool, MapError> {
    let fail = |why: String| MapError::file(path, why);
    let mut opened = open(path).map_err(fail)?;
    Ok(match opened.format {
        // Broken files are no maps; who reads them as heights says what is broken.
        Format::Png => png::text_in(opened.file, KEYWORD).is_some(),
        Format::Exr => exr::head(&mut opened.file, KEYWORD).is_ok_and(|h| h.text.is_some()),
        _ => false,
    })
}

/// Reads a map that this program wrote.
///
/// # Errors
/// The file cannot be read, or is no map, or says of itself what cannot be.
pub fn read_map(path: &Path) -> Result<MapFile, MapError> {
    decode(path, None)
}

/// Reads a map; one without a label as what it is said to be.
///
/// # Errors
/// As [`read_map`].
pub fn decode(path: &Path, foreign: Option<&Foreign>) -> Result<MapFile, MapError> {
    let read = || {
        let opened = open(path)?;
        from(opened.file, opened.format, foreign)
    };
    read().map_err(|why| MapError::file(path, why))
}

/// Reads a map from the bytes of a file, as [`read_map`] does.
///
/// # Errors
/// In words, without a file's name.
pub fn decode_bytes(bytes: &[u8]) -> Result<MapFile, String> {
    from(Cursor::new(bytes), format_of(bytes), None)
}

fn from(
    file: impl BufRead + Seek,
    format: Format,
    foreign: Option<&Foreign>,
) -> Result<MapFile, String> {
    match format {
        Format::Png => from_png(file, foreign),
        Format::Exr => from_exr(file),
        _ => Err("is no cone map: those are PNG or EXR".into()),
    }
}

/// What a file without a label lacks.
fn unlabelled(is_png: bool) -> String {
    let would = if is_png {
        "`conemarch conemap make` makes one from heights; if it is another program's map, say of which layout with --from"
    } else {
        "`conemarch conemap make` makes one from heights"
    };
    format!("does not say that it is a cone map; {would}")
}

fn from_png(file: impl BufRead + Seek, foreign: Option<&Foreign>) -> Result<MapFile, String> {
    let pixels = png::read(file, 4, KEYWORD)?;
    let read = match (&pixels.text, foreign) {
        (Some(text), _) => label::read(text)?,
        (None, Some(foreign)) => taken_for(foreign, pixels.size)?,
        (None, None) => return Err(unlabelled(true)),
    };
    if read.layout == Layout::Full {
        return Err("says that it is an EXR, and is a PNG; make the map again".into());
    }
    let channels = match read.layout {
        Layout::Pair => 2,
        _ => 4,
    };
    if pixels.channels != channels {
        return Err(format!(
            "has {} channels, and the layout `{}` has {channels}; was it saved again without alpha?",
            pixels.channels,
            read.layout.name()
        ));
    }
    check_places(&read, pixels.size)?;
    let bits = if pixels.most > 255 {
        Bits::Sixteen
    } else {
        Bits::Eight
    };
    let steps = bits.steps();
    let numbers = Ratios {
        steps,
        root: read.root,
        scale: read.label.scale,
        again: true,
    };
    let ratios = |channel: usize| pixels.channel(channel).map(|n| numbers.ratio(n));
    let heights = |channel: usize| pixels.channel(channel).map(|n| steps.height(n));
    let extra = |channel: usize, name| Extra {
        name,
        shares: heights(channel).collect(),
    };
    let (ratios, heights, extra): (Vec<f64>, Option<Vec<f32>>, Vec<Extra>) = match read.layout {
        Layout::Dummer => (
            ratios(1).collect(),
            Some(heights(0).collect()),
            vec![extra(2, "slope x"), extra(3, "slope y")],
        ),
        Layout::HeightSurface => (
            ratios(2).collect(),
            // Turned as whole numbers, so that heights come back as they were.
            Some(
                pixels
                    .channel(3)
                    .map(|n| steps.height(steps.most - n))
                    .collect(),
            ),
            vec![extra(0, "normal x"), extra(1, "normal y")],
        ),
        Layout::Quad => (
            pixels.numbers.iter().map(|n| numbers.ratio(*n)).collect(),
            None,
            Vec::new(),
        ),
        Layout::Pair | Layout::Full => {
            (ratios(1).collect(), Some(heights(0).collect()), Vec::new())
        }
    };
    let origin = Some(read.root);
    let read = Read { origin, ..read };
    Ok(finished(read, bits, pixels.size, ratios, heights, extra))
}

/// The label that a foreign file would have.
fn taken_for(foreign: &Foreign, size: [u32; 2]) -> Result<Read, String> {
    if is_walk(foreign.kind) || foreign.layout.lacks(foreign.kind).is_some() {
        return Err(format!(
            "has no label, and cannot be read as such a map in the layout `{}`",
            foreign.layout.name()
        ));
    }
    Ok(Read {
        kind: foreign.kind,
        layout: foreign.layout,
        root: foreign.root,
        wrap: foreign.wrap,
        offset: 0.0,
        origin: None,
        // His program's, most likely; cones do not depend on it.
        slopes: Slopes::Half,
        label: Label {
            samples: size,
            patches: Patches::Bilinear,
            scale: scale(size),
            digest: None,
            generator: None,
        },
    })
}

fn from_exr(mut file: impl BufRead + Seek) -> Result<MapFile, String> {
    let head = exr::head(&mut file, KEYWORD)?;
    let text = head.text.as_ref().ok_or_else(|| unlabelled(false))?;
    let read = label::read(text)?;
    if read.layout != Layout::Full {
        return Err("says that it is a PNG, and is an EXR; make the map again".into());
    }
    check_places(&read, head.size)?;
    let mut channel = |name: &str| {
        if !head.channels.iter().any(|c| c == name) {
            let all = head.channels.join(", ");
            return Err(format!(
                "has no channel {name}, only {all}; make the map again"
            ));
        }
        file.rewind().map_err(|e| format!("cannot be read: {e}"))?;
        let values = exr::channel(&mut file, name)?;
        let good = |v: &f32| (0.0..=WIDEST as f32).contains(v);
        if let Some(i) = values.iter().position(|v| !good(v)) {
            let (w, v) = (head.size[0] as usize, values[i]);
            return Err(format!(
                "{name} at column {}, row {} is {v}, which is none; make the map again",
                i % w,
                i / w
            ));
        }
        Ok(values)
    };
    let scale = read.label.scale;
    let ratio = |v: f32| (f64::from(v) * scale).min(WIDEST);
    let mut ratios = Vec::new();
    if ratios_per_place(read.kind) == 1 {
        ratios.extend(channel("ratio")?.into_iter().map(ratio));
    } else {
        let sides = SIDES.map(&mut channel);
        let [e, w, s, n] = sides;
        let (e, w, s, n) = (e?, w?, s?, n?);
        for i in 0..e.len() {
            ratios.extend([e[i], w[i], s[i], n[i]].map(ratio));
        }
    }
    // Four ratios may have come from a PNG, which has no room for heights beside them.
    let heights = match read.kind {
        MapKind::Quad if !head.channels.iter().any(|c| c == "height") => None,
        _ => Some(channel("height")?),
    };
    if heights.iter().flatten().any(|z| *z > 1.0) {
        return Err("holds a height above 1; make the map again".into());
    }
    let size = head.size;
    let bits = Bits::Sixteen;
    Ok(finished(read, bits, size, ratios, heights, Vec::new()))
}

/// A label and an image that belong together.
fn check_places(read: &Read, found: [u32; 2]) -> Result<(), String> {
    let wanted = read.places();
    if found == wanted {
        return Ok(());
    }
    Err(format!(
        "is {} x {}, and by its label should be {} x {}; it was cut or scaled, which makes cones wrong; make the map again",
        found[0], found[1], wanted[0], wanted[1]
    ))
}

fn finished(
    read: Read,
    bits: Bits,
    size: [u32; 2],
    ratios: Vec<f64>,
    heights: Option<Vec<f32>>,
    extra: Vec<Extra>,
) -> MapFile {
    MapFile {
        map: ConeMap {
            kind: read.kind,
            size,
            wrap: read.wrap,
            offset: read.offset,
            ratios,
        },
        heights,
        extra,
        slopes: None,
        origin: read.origin,
        form: Form {
            bits,
            root: read.root,
            slopes: read.slopes,
            ..Form::new(read.layout)
        },
        label: read.label,
    }
}
