//! A cone map to the bytes of a file.

use std::io::Cursor;

use ::exr::prelude::WritableImage;

use crate::heightfield::conemap::file::label::{self, KEYWORD};
use crate::heightfield::conemap::file::shading::{half, normal_shares, whole};
use crate::heightfield::conemap::file::{
    Channel, MapFile, MapFormat, RatioScale, Ratios, Slopes, narrowed, share_down,
};
use crate::heightfield::conemap::generate::slopes::slopes;
use crate::heightfield::{FileError, Heights};
use crate::raster::exr;
use crate::raster::png::{self, BitDepth};

/// Names of the ratios of the four sides in an EXR: east is +x, south +y, as rows go
/// down.
pub(crate) const SIDES: [&str; 4] = ["ratio.E", "ratio.W", "ratio.S", "ratio.N"];

/// Encodes a map in a format.
///
/// # Errors
/// The layout cannot hold such a map.
pub fn encode(file: &MapFile, format: &MapFormat) -> Result<Vec<u8>, FileError> {
    let layout = format.layout;
    let fail = |why: String| layout.error(&why);
    layout.check(file.map.kind)?;
    let mut format = *format;
    if layout.is_exr() {
        // Small numbers in f32 are as exact as large ones.
        format.ratio = RatioScale::Linear;
    }
    let text = label::write(file, &format).map_err(fail)?;
    let mut bytes = Cursor::new(Vec::new());
    let written = if layout.is_exr() {
        let image = exr::image(file.map.size, exr::channels(floats(file)), [KEYWORD, &text]);
        let written = image.write().to_buffered(&mut bytes);
        written.map_err(|e| e.to_string())
    } else {
        let numbers = numbers(file, &format).map_err(fail)?;
        let label = [(KEYWORD, text.as_str())];
        let size = file.map.size;
        let written = png::write(&mut bytes, size, format.bits, &numbers, false, &label);
        written.map_err(|e| e.to_string())
    };
    written.map_err(|e| fail(format!("could not be encoded: {e}")))?;
    Ok(bytes.into_inner())
}

/// The channels of an EXR. Heights are kept bit for bit. Ratios are shares of the scale,
/// rounded down to the next f32.
fn floats(file: &MapFile) -> Vec<(String, Vec<f32>)> {
    let share = |r: &f64| share_down(*r, file.label.scale());
    let ratios = &file.map.ratios;
    let mut channels = Vec::new();
    if let Some(heights) = &file.heights {
        channels.push(("height".to_string(), heights.clone()));
    }
    if file.map.kind.channels() == 1 {
        channels.push(("ratio".into(), ratios.iter().map(share).collect()));
    } else {
        for (side, name) in SIDES.iter().enumerate() {
            let one = ratios.iter().skip(side).step_by(SIDES.len());
            channels.push((name.to_string(), one.map(share).collect()));
        }
    }
    channels
}

/// The numbers of a PNG, pixel by pixel.
fn numbers(file: &MapFile, format: &MapFormat) -> Result<Vec<u16>, String> {
    let bits = format.bits;
    let ratios = Ratios {
        bits,
        scaling: format.ratio,
        scale: file.label.scale(),
        reread: file.origin == Some(format.ratio),
    };
    let map = &file.map;
    let layout = format.layout;
    if !layout.has(Channel::Height) && !layout.has(Channel::Depth) {
        // No heights are in the file, so nothing rises.
        let numbers = map.ratios.iter().map(|r| ratios.ratio_down(*r));
        return Ok(numbers.collect());
    }
    let heights = file
        .heights
        .as_deref()
        .ok_or("needs heights, and the map has none; make it from its heights again")?;
    let up: Vec<u16> = heights.iter().map(|z| bits.height_up(*z)).collect();
    let cones = narrowed_all(file, heights, &up, bits);
    let cones = cones.into_iter().zip(&map.ratios).map(|(r, read)| {
        // A ratio that was narrowed is a fresh one.
        let reread = ratios.reread && r == *read;
        Ratios { reread, ..ratios }.ratio_down(r)
    });
    let slopes = || {
        // Of the heights themselves, not of their rounding.
        let surface = Heights::new(map.size, map.wrap, heights.to_vec());
        surface.map(|s| slopes(&s)).map_err(|e| e.to_string())
    };
    let shading: Vec<[u16; 2]> = if layout.has(Channel::NormalX) {
        let depth = format.depth * file.label.scale();
        let normal = |slope| normal_shares(slope, depth).map(|n| bits.nearest(n));
        slopes()?.into_iter().map(normal).collect()
    } else if !layout.has(Channel::SlopeX) {
        vec![[0; 2]; up.len()]
    } else if format.slopes == Slopes::Half {
        half(&up, map.size, bits)
    } else {
        slopes()?.into_iter().map(|s| whole(s, bits)).collect()
    };
    let pixels = up.iter().zip(cones).zip(shading);
    let numbers = pixels.flat_map(|((z, ratio), [x, y])| {
        layout.facts().channels.iter().map(move |held| match held {
            Channel::Height => *z,
            Channel::Depth => bits.most() - z,
            Channel::Ratio => ratio,
            Channel::SlopeX | Channel::NormalX => x,
            Channel::SlopeY | Channel::NormalY => y,
        })
    });
    Ok(numbers.collect())
}

/// Ratios of cones that stay empty when heights rise to their numbers.
fn narrowed_all(file: &MapFile, heights: &[f32], up: &[u16], bits: BitDepth) -> Vec<f64> {
    let rise = |i: usize| f64::from(bits.height(up[i])) - f64::from(heights[i]);
    let most = (0..up.len()).map(rise).fold(0.0, f64::max);
    let top = heights.iter().copied().fold(0.0, f32::max);
    let nearest = if file.map.kind.over_cells() {
        file.map.offset
    } else {
        1.0
    };
    let one = |(i, ratio): (usize, &f64)| {
        // Nothing can rise above the highest: rounding keeps the order.
        if heights[i] >= top {
            return *ratio;
        }
        narrowed(*ratio, most - rise(i), nearest)
    };
    file.map.ratios.iter().enumerate().map(one).collect()
}
