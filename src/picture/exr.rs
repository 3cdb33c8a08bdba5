//! OpenEXR: one part with everything that a frame knows, in f32. The same frame gives the
//! same bytes.
//!
//! Channels: `R`, `G`, `B` linear, `A` 1; `Z` the distance along the view axis and `depth.Z`
//! along the ray, [`FAR`] for sky, and the distance reached where a limit stopped the ray;
//! `normal.X`..`Z` and `position.X`..`Z` in the world; `state.Y` 0 sky, 1 hit, 2 unconverged;
//! `steps.Y` where evaluations were counted. Attributes: the preset, the camera, the program,
//! pixels per inch and the chromaticities of sRGB.

use std::io::{Seek, Write};

use exr::meta::attribute::Chromaticities;
use exr::prelude::{Vec2, WritableImage};

use crate::picture::SOFTWARE;
use crate::picture::error::OutputError;
use crate::picture::frame::Frame;
use crate::plan::Plan;
use crate::preset::PNG_KEYWORD;
use crate::raster::exr::{image, text_of};

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
    let mut list = Vec::new();
    let mut channel = |name: &str, values| list.push((name.to_string(), values));
    let one = |of: &[[f32; 3]], i: usize| of.iter().map(|v| v[i]).collect::<Vec<f32>>();
    let view = plan.view();
    let position = frame.positions(&view);
    for (i, (rgb, xyz)) in ["R", "G", "B"].iter().zip(["X", "Y", "Z"]).enumerate() {
        channel(rgb, one(&frame.radiance, i));
        channel(&format!("normal.{xyz}"), one(&frame.normal, i));
        channel(&format!("position.{xyz}"), one(&position, i));
    }
    drop(position);
    channel("A", vec![1.0; frame.depth.len()]);
    let forward = (plan.camera.target - plan.camera.eye).normalize();
    let depths = frame.depth.iter().enumerate();
    let planar = depths.map(|(i, t)| {
        let slant = frame.ray(&view, i).axis.dot(forward);
        finite((f64::from(*t) * slant) as f32)
    });
    channel("Z", planar.collect());
    channel("depth.Z", frame.depth.iter().copied().map(finite).collect());
    let states = frame.state.iter().map(|s| f32::from(*s));
    channel("state.Y", states.collect());
    if !frame.work.is_empty() {
        channel("steps.Y", frame.steps());
    }
    let mut image = image(frame.size, list, [PNG_KEYWORD, preset]);
    image.layer_data.attributes.software_name = Some(SOFTWARE.into());
    image.layer_data.attributes.horizontal_density = plan.ppi.map(|ppi| ppi as f32);
    image.attributes.chromaticities = Some(SRGB);
    // The maps of further attributes are written in no certain order: one in each.
    let other = &mut image.attributes.other;
    other.insert("conemarch camera".into(), text_of(&camera(plan)));
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
