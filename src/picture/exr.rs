//! OpenEXR: one part with everything that a frame knows, in f32. The same frame gives the
//! same bytes.
//!
//! Channels: `R`, `G`, `B` linear, `A` 1, or over a transparent background the share of the samples
//! that hit, with colours that are multiplied by it; `Z` the distance along the view axis and `depth.Z`
//! along the ray, [`FAR`] for sky, and the distance reached where a limit stopped the ray;
//! `normal.X`..`Z` and `position.X`..`Z` in the world; `state.Y` 0 sky, 1 hit, 2 unconverged;
//! `variance.Y` the variance of the luminance if there are two samples or more;
//! `samples.Y` where `image.until` may end some tiles before others; `steps.Y` where evaluations were counted. Attributes: the preset, the camera, the program,
//! pixels per inch and the chromaticities of sRGB.

use std::io::{Seek, Write};

use exr::image::write::channels::WritableChannels;
use exr::meta::attribute::Chromaticities;
use exr::prelude::{Image, IntegerBounds, Layer, Vec2, WritableImage};

use crate::picture::SOFTWARE;
use crate::picture::error::OutputError;
use crate::picture::frame::Frame;
use crate::plan::{Extras, Plan};
use crate::preset::PNG_KEYWORD;
use crate::raster::exr::{self as file, Rows, image, text_of};

/// Depth of the sky: farther than any scene, and finite, as compositors compute with it.
/// Blender writes the same number.
pub const FAR: f32 = 1e10;

/// The primaries and the white of sRGB, which are those of Rec. 709.
const SRGB: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// Channels by their names, row by row.
pub type Named = Vec<(String, Vec<f32>)>;

/// Writes a frame that was rendered with normals. `preset` is the text of the plan.
///
/// # Errors
/// The disk is full.
pub fn write_exr(
    to: &mut (impl Write + Seek),
    frame: &Frame,
    plan: &Plan,
    preset: &str,
) -> Result<(), OutputError> {
    let list = file::channels(channels(frame, plan));
    encode(to, &described(plan.size, list, plan, preset))
}

/// The names of the channels of [`write_exr`], sorted.
pub fn exr_names(plan: &Plan, extras: Extras) -> Vec<String> {
    let always = [
        "A",
        "B",
        "G",
        "R",
        "Z",
        "depth.Z",
        "normal.X",
        "normal.Y",
        "normal.Z",
        "position.X",
        "position.Y",
        "position.Z",
        "state.Y",
    ];
    let others = [
        ("samples.Y", plan.is_adaptive()),
        ("steps.Y", extras.count),
        ("variance.Y", plan.has_variance(extras)),
    ];
    let others = others.into_iter().filter(|(_, is_there)| *is_there);
    let mut names: Vec<_> = always
        .into_iter()
        .chain(others.map(|(name, _)| name))
        .collect();
    names.sort();
    names.into_iter().map(String::from).collect()
}

/// Bytes of a row of so many channels in [`exr_rows`].
pub fn exr_row_bytes(plan: &Plan, channels: usize) -> usize {
    4 * plan.size[0] as usize * channels
}

/// The rows of a frame that is a part of the picture, as wide as it, for [`write_exr_rows`].
pub fn exr_rows(frame: &Frame, plan: &Plan) -> Vec<u8> {
    let mut list = channels(frame, plan);
    list.sort_by(|(a, _), (b, _)| a.cmp(b));
    exr_rows_of(&list, frame.size[0])
}

/// The same of channels in the order of their names, of a picture of so many columns.
pub fn exr_rows_of(list: &Named, width: u32) -> Vec<u8> {
    let width = width as usize;
    let pixels = list.first().map_or(0, |(_, values)| values.len());
    let mut rows = Vec::with_capacity(4 * list.len() * pixels);
    for first in (0..pixels).step_by(width) {
        for (_, values) in list {
            let row = &values[first..first + width];
            rows.extend(row.iter().flat_map(|value| value.to_le_bytes()));
        }
    }
    rows
}

/// Writes the file of [`write_exr`] from parts of its rows, of channels of these names. `read` is told
/// the first row and how many, in ascending order, and returns what [`exr_rows`] makes of them. The parts
/// are 32 rows high and begin at multiples of that.
///
/// # Errors
/// `read` fails, or the disk is full.
pub fn write_exr_rows<E: From<OutputError> + Send>(
    to: &mut (impl Write + Seek),
    (plan, names): (&Plan, Vec<String>),
    preset: &str,
    mut read: impl FnMut(usize, usize) -> Result<Vec<u8>, E> + Send,
) -> Result<(), E> {
    let mut failed = None;
    let row = exr_row_bytes(plan, names.len());
    // The encoder takes no error. What is written after one is nothing.
    let rows = Rows::new(names, |first, count| {
        let zeros = || vec![0; count * row];
        if failed.is_some() {
            return zeros();
        }
        read(first, count).unwrap_or_else(|e| {
            failed = Some(e);
            zeros()
        })
    });
    let written = encode(to, &described(plan.size, rows, plan, preset));
    match failed {
        Some(e) => Err(e),
        None => written.map_err(E::from),
    }
}

/// Writes the frame of a plan's window as a part of the whole image: the file's display window is
/// the image, and its data window the part. `comments` is a text for people and for `merge`.
///
/// # Errors
/// The disk is full.
pub fn write_exr_part(
    to: &mut (impl Write + Seek),
    frame: &Frame,
    plan: &Plan,
    preset: &str,
    comments: &str,
) -> Result<(), OutputError> {
    let mut image = described(
        frame.size,
        file::channels(channels(frame, plan)),
        plan,
        preset,
    );
    let place = frame.origin.map(|o| o as i32);
    let size = plan.size.map(|n| n as usize);
    image.attributes.display_window = IntegerBounds::from_dimensions((size[0], size[1]));
    image.layer_data.attributes.layer_position = Vec2(place[0], place[1]);
    image.layer_data.attributes.comments = Some(comments.into());
    encode(to, &image)
}

/// What a frame knows.
fn channels(frame: &Frame, plan: &Plan) -> Named {
    let mut list = Vec::new();
    let mut channel = |name: &str, values| list.push((name.to_string(), values));
    let one = |of: &[[f32; 3]], i: usize| of.iter().map(|v| v[i]).collect::<Vec<f32>>();
    let rays = plan.picture_rays();
    let position = frame.positions(&rays);
    for (i, (rgb, xyz)) in ["R", "G", "B"].iter().zip(["X", "Y", "Z"]).enumerate() {
        channel(rgb, one(&frame.radiance, i));
        channel(&format!("normal.{xyz}"), one(&frame.normal, i));
        channel(&format!("position.{xyz}"), one(&position, i));
    }
    drop(position);
    channel(
        "A",
        match frame.alpha.is_empty() {
            true => vec![1.0; frame.depth.len()],
            false => frame.alpha.clone(),
        },
    );
    let forward = (plan.camera.target - plan.camera.eye).normalize();
    let depths = frame.depth.iter().enumerate();
    let planar = depths.map(|(i, t)| {
        let slant = rays.ray(frame.pixel(i)).1.axis.dot(forward);
        finite((f64::from(*t) * slant) as f32)
    });
    channel("Z", planar.collect());
    channel("depth.Z", frame.depth.iter().copied().map(finite).collect());
    let states = frame.state.iter().map(|s| f32::from(*s));
    channel("state.Y", states.collect());
    if !frame.samples.is_empty() {
        channel(
            "samples.Y",
            frame.samples.iter().map(|n| *n as f32).collect(),
        );
    }
    if !frame.variance.is_empty() {
        channel("variance.Y", frame.variance.clone());
    }
    if !frame.work.is_empty() {
        channel("steps.Y", frame.steps());
    }
    list
}

/// Channels with all attributes.
fn described<'a, C: WritableChannels<'a> + 'a>(
    size: [u32; 2],
    channels: C,
    plan: &Plan,
    preset: &str,
) -> Image<Layer<C>> {
    let mut image = image(size, channels, [PNG_KEYWORD, preset]);
    let own = &mut image.layer_data.attributes;
    own.software_name = Some(SOFTWARE.into());
    own.comments = Some(plan.title.as_str().into()).filter(|_| !plan.title.is_empty());
    own.horizontal_density = plan.ppi.map(|ppi| ppi as f32);
    image.attributes.chromaticities = Some(SRGB);
    // The maps of further attributes are written in no certain order: one in each.
    let other = &mut image.attributes.other;
    other.insert("conemarch camera".into(), text_of(&camera(plan)));
    image
}

fn encode<'a, C: WritableChannels<'a> + 'a>(
    to: &mut (impl Write + Seek),
    image: &'a Image<Layer<C>>,
) -> Result<(), OutputError> {
    let written = image.write().to_buffered(to);
    written.map_err(|e| OutputError::encode("EXR", e))
}

fn finite(t: f32) -> f32 {
    if t.is_finite() { t } else { FAR }
}

/// The camera as a preset says it: eye, target, up and vertical field of view.
fn camera(plan: &Plan) -> String {
    let mut camera = plan.camera.clone();
    let keys = camera.keys().into_iter();
    let lines = keys.map(|k| format!("{} = {}", k.name, k.slot.get()));
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu;
    use crate::scene::{Assets, Scene};

    #[test]
    fn a_picture_in_parts_has_the_channels_of_one_at_once() {
        let mut plan = Plan::new(Scene::all().into_iter().next().expect("a scene"));
        plan.size = [16, 8];
        let mut extras = Extras {
            normals: true,
            ..Extras::default()
        };
        for samples in [1, 16] {
            plan.samples = samples;
            plan.until = 0.01 * f64::from(samples - 1);
            extras.variance = samples > 1;
            extras.count = samples > 1;
            let watch = &mut |_: &_| true;
            let frame = cpu::render(&plan, &Assets::default(), extras, watch).expect("a frame");
            let list = channels(&frame, &plan).into_iter();
            let mut there: Vec<String> = list.map(|(name, _)| name).collect();
            there.sort();
            assert_eq!(there, exr_names(&plan, extras));
        }
    }
}
