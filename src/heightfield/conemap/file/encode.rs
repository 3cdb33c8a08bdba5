//! A cone map to the bytes of a file.

use std::borrow::Cow;

use crate::heightfield::conemap::file::error::MapError;
use crate::heightfield::conemap::file::form::{Form, Layout, MapFile, Slopes};
use crate::heightfield::conemap::file::label::{self, KEYWORD};
use crate::heightfield::conemap::file::round::{Ratios, Steps, narrowed, share_down};
use crate::heightfield::conemap::file::slopes::{half, normal_shares, whole};
use crate::heightfield::conemap::file::words::is_walk;
use crate::heightfield::conemap::generate::slopes;
use crate::heightfield::heights::Heights;
use crate::heightfield::raster::{exr, png};

/// Names of the ratios of the four sides in an EXR: east is +x, south +y, as rows go
/// down.
pub(crate) const SIDES: [&str; 4] = ["ratio.E", "ratio.W", "ratio.S", "ratio.N"];

/// Encodes a map in a form.
///
/// # Errors
/// The layout cannot hold such a map.
pub fn encode(file: &MapFile, form: &Form) -> Result<Vec<u8>, MapError> {
    let layout = form.layout;
    let fail = |why: String| MapError::Layout {
        layout: layout.name(),
        why,
    };
    if let Some(why) = layout.lacks(file.map.kind) {
        return Err(fail(why.into()));
    }
    // Nothing is rooted in f32, whose small numbers are as exact as its large ones.
    let form = &Form {
        root: form.root && layout != Layout::Full,
        ..*form
    };
    let text = label::write(file, form).map_err(fail)?;
    let mut bytes = Vec::new();
    if layout == Layout::Full {
        let channels = floats(file);
        let written = exr::write(&mut bytes, file.map.size, channels, [KEYWORD, &text]);
        written.map_err(|e| fail(format!("could not be encoded: {e}")))?;
        return Ok(bytes);
    }
    let (kept, numbers) = numbers(file, form).map_err(fail)?;
    let pixels = png::Pixels {
        size: file.map.size,
        kept,
        channels: kept,
        most: form.bits.steps().most,
        numbers,
        is_grey: kept < 3,
        is_opaque: false,
        text: Some(text),
    };
    let written = png::write(&mut bytes, &pixels, KEYWORD);
    written.map_err(|e| fail(format!("could not be encoded: {e}")))?;
    Ok(bytes)
}

/// The channels of an EXR. Heights are kept bit for bit, and ratios, being shares of the
/// scale, to the next f32 below.
fn floats(file: &MapFile) -> Vec<(String, Vec<f32>)> {
    let share = |r: &f64| share_down(*r, file.label.scale);
    let ratios = &file.map.ratios;
    let mut channels = Vec::new();
    if let Some(heights) = &file.heights {
        channels.push(("height".to_string(), heights.clone()));
    }
    if ratios.len() == places(file) {
        channels.push(("ratio".into(), ratios.iter().map(share).collect()));
    } else {
        for (side, name) in SIDES.iter().enumerate() {
            let one = ratios.iter().skip(side).step_by(SIDES.len());
            channels.push((name.to_string(), one.map(share).collect()));
        }
    }
    channels
}

fn places(file: &MapFile) -> usize {
    file.map.size[0] as usize * file.map.size[1] as usize
}

/// Channels and numbers of a PNG.
fn numbers(file: &MapFile, form: &Form) -> Result<(usize, Vec<u16>), String> {
    let steps = form.bits.steps();
    let ratios = Ratios {
        steps,
        root: form.root,
        scale: file.label.scale,
        again: file.origin == Some(form.root),
    };
    let map = &file.map;
    if form.layout == Layout::Quad {
        // No heights are in the file, so nothing rises.
        let numbers = map.ratios.iter().map(|r| ratios.ratio_down(*r));
        return Ok((SIDES.len(), numbers.collect()));
    }
    let heights = file
        .heights
        .as_deref()
        .ok_or("wants heights, and the map comes without; make it from its heights again")?;
    let up: Vec<u16> = heights.iter().map(|z| steps.height_up(*z)).collect();
    let cones = narrowed_all(file, heights, &up, steps);
    let cones = cones.into_iter().zip(&map.ratios).map(|(r, read)| {
        // One that was narrowed is a fresh one.
        let again = ratios.again && r == *read;
        Ratios { again, ..ratios }.ratio_down(r)
    });
    let both = up.iter().copied().zip(cones);
    if form.layout == Layout::Pair {
        return Ok((2, both.flat_map(|(z, r)| [z, r]).collect()));
    }
    if form.layout == Layout::Dummer {
        let slopes = match form.slopes {
            Slopes::Half => half(&up, map.size, steps),
            Slopes::Whole => {
                let all = slopes(file, heights)?;
                all.iter().map(|slope| whole(*slope, steps)).collect()
            }
        };
        let all = both.zip(slopes).flat_map(|((z, r), [x, y])| [z, r, x, y]);
        return Ok((4, all.collect()));
    }
    let depth = form.depth * file.label.scale;
    let slopes = slopes(file, heights)?;
    let all = both.zip(slopes.iter()).flat_map(|((z, r), slope)| {
        let [x, y] = normal_shares(*slope, depth).map(|n| steps.nearest(n));
        [x, y, r, steps.most - z]
    });
    Ok((4, all.collect()))
}

/// The slopes of the heights themselves, not of their rounding.
fn slopes<'a>(file: &'a MapFile, heights: &[f32]) -> Result<Cow<'a, [[f32; 2]]>, String> {
    if let Some(made) = &file.slopes {
        return Ok(Cow::Borrowed(made));
    }
    let map = &file.map;
    let surface = Heights::new(map.size, map.wrap, heights.to_vec()).map_err(|e| e.to_string())?;
    Ok(Cow::Owned(slopes::slopes(&surface)))
}

/// Ratios that stay clear when heights rise to their numbers.
fn narrowed_all(file: &MapFile, heights: &[f32], up: &[u16], steps: Steps) -> Vec<f64> {
    let rise = |i: usize| f64::from(steps.height(up[i])) - f64::from(heights[i]);
    let most = (0..up.len()).map(rise).fold(0.0, f64::max);
    let top = heights.iter().copied().fold(0.0, f32::max);
    let nearest = if is_walk(file.map.kind) {
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
