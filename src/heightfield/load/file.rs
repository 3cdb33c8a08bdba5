//! The numbers in a height map's file: whole numbers as shares of their largest, floats as
//! they are.
//!
//! **Which channel.** The first channel holds the heights: grey, or red, as in cone step
//! maps. Alpha is not a height and is left out. In an EXR the heights are in a
//! channel called `height`, else `Y`, `Z` or `R`, else in the only one. In
//! names with a dot, `height` may stand before or after it, the letters after it. Cone
//! maps of this program say which channel holds heights, or depths. Cone maps
//! without heights of samples are refused.
//!
//! **Raw files** (.raw, .f32 or .r32) hold f32, little endian, row by row, and nothing
//! else. Their size is an option or part of the name, as in `heights-512x256.raw`.

use std::io::Read;
use std::path::Path;

use crate::heightfield::Patches;
use crate::heightfield::conemap::file::{decode_as, has_map};
use crate::heightfield::load::pattern_spec::read_size;
use crate::raster::open::{Format, Opened, open};
use crate::raster::{exr, png, tiff};

/// Numbers of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Numbers row by row; floats may be anything.
    pub values: Vec<f32>,
    /// The format of the file, in words.
    pub form: String,
    /// What was left out of the file, if it is not obvious.
    pub note: Option<String>,
}

/// Reads a file of any format. `size` is that of a raw file.
///
/// # Errors
/// In words, without the file's name.
pub fn read(path: &Path, size: Option<[u32; 2]>) -> Result<Grid, String> {
    let mut opened = open(path)?;
    if size.is_some() && opened.format != Format::Other {
        return Err("has a size of its own; leave out --size, which is for raw files".into());
    }
    if has_map(path) {
        return of_map(opened);
    }
    match opened.format {
        Format::Png => read_png(opened),
        Format::Exr => read_exr(&mut opened),
        Format::Tiff => read_tiff(opened),
        Format::Jpeg => Err(
            "is a JPEG, whose compression makes steps in heights; save it as PNG or TIFF".into(),
        ),
        Format::Other => read_raw(path, opened, size),
    }
}

/// The heights in a cone map of this program.
fn of_map(opened: Opened) -> Result<Grid, String> {
    let file = decode_as(opened.format, opened.file, None)?;
    let instead = "name the heights that it was made from";
    let values = file
        .heights
        .ok_or_else(|| format!("is a cone map that holds no heights; {instead}"))?;
    let kind = file.map.kind;
    if kind.over_cells() && file.label.patches != Patches::Boxes {
        return Err(format!(
            "is a cone map of the kind `{}`, whose heights are of cells, not of samples; {instead}",
            kind.name()
        ));
    }
    let (layout, name) = (file.format.layout, file.format.layout.name());
    Ok(Grid {
        size: file.map.size,
        values,
        form: match layout.is_exr() {
            true => "EXR, cone map".into(),
            false => format!(
                "PNG, cone map, layout {name}, {} bit",
                file.format.bits as u8
            ),
        },
        note: Some(format!(
            "is a cone map of the layout `{name}`: its heights are taken, from {}",
            layout.facts().heights
        )),
    })
}

fn read_png(opened: Opened) -> Result<Grid, String> {
    let pixels = png::read(opened.file, 1)?;
    let colors = ["grey", "grey and alpha", "colour", "colour and alpha"];
    let bits = pixels.depth as u8;
    let note = if !pixels.is_grey {
        Some("has colours: red is taken as the height")
    } else if !pixels.is_opaque {
        Some("is transparent in places: alpha is left out")
    } else {
        None
    };
    Ok(Grid {
        size: pixels.size,
        values: pixels.channel(0).map(|n| pixels.depth.height(n)).collect(),
        form: format!("PNG, {}, {bits} bit", colors[(pixels.channels - 1).min(3)]),
        note: note.map(str::to_string),
    })
}

fn read_exr(opened: &mut Opened) -> Result<Grid, String> {
    let head = exr::head(&mut opened.file, "")?;
    let name = chosen(&head.channels).ok_or_else(|| {
        format!(
            "is an EXR with the channels {}, none of which is called height, Y, Z or R; rename the one to take",
            head.channels.join(", ")
        )
    })?;
    let values = exr::channel(&mut opened.file, name)?;
    let others = head.channels.len() - 1;
    Ok(Grid {
        size: head.size,
        values,
        form: format!("EXR, channel {name}"),
        note: (others > 0).then(|| format!("has {others} more channels: {name} is the height")),
    })
}

/// The channel that holds heights.
fn chosen(channels: &[String]) -> Option<&str> {
    let find = |fits: &dyn Fn(&str) -> bool| channels.iter().find(|c| fits(&c.to_lowercase()));
    let height = |c: &str| c == "height" || c.starts_with("height.") || c.ends_with(".height");
    let letter = |letter| find(&|c| c.rsplit('.').next() == Some(letter));
    let letters = ["y", "z", "r"].into_iter().find_map(letter);
    let only = (channels.len() == 1).then(|| channels.first()).flatten();
    find(&height).or(letters).or(only).map(String::as_str)
}

fn read_tiff(opened: Opened) -> Result<Grid, String> {
    let channel = tiff::read(opened.file)?;
    let others = channel.channels - 1;
    Ok(Grid {
        size: channel.size,
        values: channel.values,
        form: "TIFF".into(),
        note: (others > 0).then(|| format!("has {others} more channels: the first is the height")),
    })
}

/// Endings of raw files.
const RAW: [&str; 3] = ["raw", "f32", "r32"];

fn read_raw(path: &Path, mut opened: Opened, size: Option<[u32; 2]>) -> Result<Grid, String> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let is_raw = RAW.contains(&ending.to_lowercase().as_str());
    if !is_raw && size.is_none() {
        return Err(
            "is neither PNG, EXR nor TIFF; files of raw 32-bit floats end in .raw, or need --size"
                .into(),
        );
    }
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned());
    let named = stem.and_then(|s| size_in(&s));
    if let (Some([w, h]), Some([x, y])) = (size, named)
        && size != named
    {
        return Err(format!(
            "is {x} x {y} by its name, and {w} x {h} by --size; leave out --size, or rename it"
        ));
    }
    let size = size.or(named);
    let Some([w, h]) = size else {
        return Err(
            "is raw and does not tell its size; put it into the name like heights-512x256.raw, or give --size WxH to a command that has this option"
                .into(),
        );
    };
    let wanted = u64::from(w) * u64::from(h) * 4;
    if opened.bytes != wanted {
        let hint = if opened.bytes * 2 == wanted {
            "; it may hold 16-bit numbers, which a 16-bit PNG or TIFF would carry"
        } else if named.is_some() {
            "; the size in its name is wrong"
        } else {
            "; give the right --size"
        };
        return Err(format!(
            "has {} bytes, and {w} x {h} floats of 32 bits are {wanted}{hint}",
            opened.bytes
        ));
    }
    let mut bytes = Vec::with_capacity(wanted as usize);
    let mut part = opened.file.by_ref().take(wanted);
    let read = part.read_to_end(&mut bytes);
    read.map_err(|e| format!("cannot be read: {e}"))?;
    if bytes.len() as u64 != wanted {
        return Err("became shorter while it was being read; try again".into());
    }
    let float = |b: &[u8]| f32::from_le_bytes(b.try_into().unwrap_or_default());
    Ok(Grid {
        size: [w, h],
        values: bytes.chunks_exact(4).map(float).collect(),
        form: "raw, 32-bit floats".into(),
        note: None,
    })
}

/// The size at the end of a name: `heights-512x256`, `heights_512x256`, `512x256`.
fn size_in(stem: &str) -> Option<[u32; 2]> {
    let last = stem.rsplit(['-', '_', ' ', '.']).next()?;
    read_size(last).ok()
}
