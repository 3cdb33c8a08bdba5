//! A file to a cone map.
//!
//! A file of another program has no label. The caller must say what it is
//! ([`ForeignFormat`]), and is believed. The other program may have rounded ratios up.

use std::io::{BufRead, Cursor, Seek, SeekFrom};
use std::path::Path;

use crate::heightfield::conemap::file::label::{self, KEYWORD};
use crate::heightfield::conemap::file::{
    Channel, Label, Layout, MapFile, MapFormat, RatioScale, Ratios, ShadingChannel, Slopes,
    encode::SIDES,
};
use crate::heightfield::{ConeMap, FileError, Patches, conemap::WIDEST};
use crate::raster::exr;
use crate::raster::open::{Format, format_of, open};
use crate::raster::png::{self, BitDepth};
use crate::raster::text_chunk::{self, SIGNATURE};

/// What a file without a label contains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForeignFormat {
    /// Its channels; not [`Layout::Full`].
    pub layout: Layout,
    /// How its numbers stand for ratios.
    pub ratio: RatioScale,
    /// Which axes wrap.
    pub wrap: [bool; 2],
}

/// Whether a file is a cone map of this program. One that is broken or cannot be read is not;
/// reading it as heights reports what is wrong.
pub fn has_map(path: &Path) -> bool {
    open(path).is_ok_and(|mut opened| match opened.format {
        Format::Png => text_of(&mut opened.file).is_ok_and(|text| text.is_some()),
        Format::Exr => exr::head(&mut opened.file, KEYWORD).is_ok_and(|h| h.text.is_some()),
        _ => false,
    })
}

/// Reads a map that this program wrote.
///
/// # Errors
/// The file cannot be read, is not a map, or has a label that contradicts itself.
pub fn read_map(path: &Path) -> Result<MapFile, FileError> {
    decode(path, None)
}

/// Reads a map. One without a label is read as `foreign` says.
///
/// # Errors
/// As [`read_map`].
pub fn decode(path: &Path, foreign: Option<&ForeignFormat>) -> Result<MapFile, FileError> {
    let read = || {
        let opened = open(path)?;
        decode_as(opened.format, opened.file, foreign)
    };
    read().map_err(|why| FileError::file(path, why))
}

/// Reads a map from the bytes of a file, as [`read_map`] does.
///
/// # Errors
/// In words, without a file's name.
pub fn decode_bytes(bytes: &[u8]) -> Result<MapFile, String> {
    decode_as(format_of(bytes), Cursor::new(bytes), None)
}

/// Reads a map from a file of a format.
pub(crate) fn decode_as(
    format: Format,
    file: impl BufRead + Seek,
    foreign: Option<&ForeignFormat>,
) -> Result<MapFile, String> {
    match format {
        Format::Png => from_png(file, foreign),
        Format::Exr => from_exr(file),
        _ => Err("is not a cone map; cone maps are PNG or EXR".into()),
    }
}

/// The error for a file without a label.
fn unlabelled(is_png: bool) -> String {
    let more = match is_png {
        true => "; if another program wrote the map, give its layout with --from",
        false => "",
    };
    format!("has no label of a cone map; `conemarch conemap make` makes a map from heights{more}")
}

/// The text of the label in a PNG; puts the reader back to its start.
fn text_of(file: &mut (impl BufRead + Seek)) -> Result<Option<String>, String> {
    let unreadable = |e| format!("cannot be read: {e}");
    let behind = SeekFrom::Start(SIGNATURE.len() as u64);
    file.seek(behind).map_err(unreadable)?;
    let text = text_chunk::text(file, KEYWORD);
    file.rewind().map_err(unreadable)?;
    text
}

fn from_png(
    mut file: impl BufRead + Seek,
    foreign: Option<&ForeignFormat>,
) -> Result<MapFile, String> {
    let text = text_of(&mut file);
    // What is wrong with the whole file comes first.
    let pixels = png::read(file, 4)?;
    let mut map_file = match (text?, foreign) {
        (Some(text), _) => label::read(&text)?,
        (None, Some(foreign)) => assumed(foreign, pixels.size),
        (None, None) => return Err(unlabelled(true)),
    };
    let layout = map_file.format.layout;
    if layout.is_exr() {
        return Err("is a PNG, and its label says EXR; make the map again".into());
    }
    let channels = layout.facts().channels;
    if pixels.channels != channels.len() {
        return Err(format!(
            "has {} channels, and the layout `{}` has {}; was it saved again without alpha?",
            pixels.channels,
            layout.name(),
            channels.len()
        ));
    }
    check_places(&map_file, pixels.size)?;
    let (bits, ratio) = (pixels.depth, map_file.format.ratio);
    let numbers = Ratios {
        bits,
        scaling: ratio,
        scale: map_file.label.scale(),
        reread: true,
    };
    let held = pixels.numbers.iter().zip(channels.iter().cycle());
    let ratios = held.filter(|(_, channel)| **channel == Channel::Ratio);
    map_file.map.ratios = ratios.map(|(n, _)| numbers.ratio(*n)).collect();
    for (i, channel) in channels.iter().enumerate() {
        let shares = pixels.channel(i);
        match channel {
            Channel::Ratio => {}
            Channel::Height => map_file.heights = Some(shares.map(|n| bits.height(n)).collect()),
            // Turned as whole numbers, so that heights come back exactly.
            Channel::Depth => {
                let heights = shares.map(|n| bits.height(bits.most() - n));
                map_file.heights = Some(heights.collect());
            }
            _ => map_file.shading.push(ShadingChannel {
                name: channel.name(),
                shares: shares.map(|n| bits.height(n)).collect(),
            }),
        }
    }
    map_file.origin = Some(ratio);
    map_file.format.bits = bits;
    Ok(map_file)
}

/// What the label of a foreign file would say.
fn assumed(foreign: &ForeignFormat, size: [u32; 2]) -> MapFile {
    let map = ConeMap {
        kind: foreign.layout.facts().foreign,
        size,
        wrap: foreign.wrap,
        offset: 0.0,
        ratios: Vec::new(),
    };
    let format = MapFormat {
        ratio: foreign.ratio,
        // As Dummer's program writes them, most likely; cones do not depend on it.
        slopes: Slopes::Half,
        ..MapFormat::new(foreign.layout)
    };
    let label = Label {
        samples: size,
        patches: Patches::Bilinear,
        digest: None,
        generator: None,
    };
    MapFile::bare(map, format, label)
}

fn from_exr(mut file: impl BufRead + Seek) -> Result<MapFile, String> {
    let head = exr::head(&mut file, KEYWORD)?;
    let text = head.text.as_ref().ok_or_else(|| unlabelled(false))?;
    let mut map_file = label::read(text)?;
    if !map_file.format.layout.is_exr() {
        return Err("is an EXR, and its label says PNG; make the map again".into());
    }
    check_places(&map_file, head.size)?;
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
                "{name} at column {}, row {} is {v}, which is out of range; make the map again",
                i % w,
                i / w
            ));
        }
        Ok(values)
    };
    let (kind, scale) = (map_file.map.kind, map_file.label.scale());
    let ratio = |v: f32| (f64::from(v) * scale).min(WIDEST);
    let names = if kind.channels() == 1 {
        &["ratio"][..]
    } else {
        &SIDES
    };
    let cones: Vec<Vec<f32>> = names.iter().map(|n| channel(n)).collect::<Result<_, _>>()?;
    let places = 0..cones[0].len();
    let ratios = places.flat_map(|i| cones.iter().map(move |cone| ratio(cone[i])));
    map_file.map.ratios = ratios.collect();
    // Four ratios may come from a PNG, which has no room for heights beside them.
    map_file.heights = match kind {
        _ if kind.channels() > 1 && !head.channels.iter().any(|c| c == "height") => None,
        _ => Some(channel("height")?),
    };
    if map_file.heights.iter().flatten().any(|z| *z > 1.0) {
        return Err("holds a height above 1; make the map again".into());
    }
    map_file.format.bits = BitDepth::Sixteen;
    Ok(map_file)
}

/// Checks that an image has the size that its label says.
fn check_places(map_file: &MapFile, [w, h]: [u32; 2]) -> Result<(), String> {
    let wanted = map_file.map.size;
    if wanted == [w, h] {
        return Ok(());
    }
    Err(format!(
        "is {w} x {h}, and its label says {} x {}; it was cut or scaled, which makes cones wrong; make the map again",
        wanted[0], wanted[1]
    ))
}
