//! OpenEXR: one part with everything a frame knows, in f32.
//!
//! `R`, `G`, `B` linear; `depth.Z` radial, infinity for sky; `normal.X`..`Z` and
//! `position.X`..`Z` in the world; `state.Y` 0 sky, 1 hit, 2 unconverged; `steps.Y`
//! where evaluations were counted.

use std::io::{Seek, Write};

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, LayerAttributes, SmallVec, WritableImage,
};

use crate::picture::error::OutputError;
use crate::picture::frame::Frame;
use crate::plan::Plan;

/// Writes a frame that was rendered with normals.
///
/// # Errors
/// The disk is full.
pub fn write_exr(
    to: &mut (impl Write + Seek),
    frame: &Frame,
    plan: &Plan,
) -> Result<(), OutputError> {
    let mut list = SmallVec::new();
    let mut channel = |name: &str, values: Vec<f32>| {
        list.push(AnyChannel::new(name, FlatSamples::F32(values)));
    };
    let one = |of: &[[f32; 3]], i: usize| of.iter().map(|v| v[i]).collect::<Vec<f32>>();
    let position = frame.positions(&plan.view());
    for (i, (rgb, xyz)) in ["R", "G", "B"].iter().zip(["X", "Y", "Z"]).enumerate() {
        channel(rgb, one(&frame.radiance, i));
        channel(&format!("normal.{xyz}"), one(&frame.normal, i));
        channel(&format!("position.{xyz}"), one(&position, i));
    }
    drop(position);
    channel("depth.Z", frame.depth.clone());
    channel(
        "state.Y",
        frame.state.iter().map(|s| f32::from(*s)).collect(),
    );
    if !frame.work.is_empty() {
        channel("steps.Y", frame.steps());
    }
    let size = (frame.size[0] as usize, frame.size[1] as usize);
    let layer = exr::prelude::Layer::new(
        size,
        LayerAttributes::default(),
        // Lossless, and quick on both sides.
        Encoding::SMALL_FAST_LOSSLESS,
        AnyChannels::sort(list),
    );
    let image = Image::from_layer(layer);
    image
        .write()
        .to_buffered(to)
        .map_err(|e| OutputError::Encode {
            format: "EXR",
            why: e.to_string(),
        })
}
