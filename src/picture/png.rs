//! PNG with 8 or 16 bits per channel, and with its preset, title and program as text.

use std::io::Write;

use crate::picture::SOFTWARE;
use crate::picture::error::OutputError;
use crate::picture::layer::Shades;
use crate::preset::PNG_KEYWORD;
use crate::raster::png::{self, BitDepth};

/// Keyword of the text that names the layer, if it is not the colours.
pub const LAYER_KEYWORD: &str = "conemarch layer";

/// Writes a layer as PNG. `preset` is the text of the plan that it was rendered from.
///
/// # Errors
/// The disk is full.
pub fn write_png(
    to: &mut dyn Write,
    shades: &Shades<'_>,
    depth: BitDepth,
    title: &str,
    preset: &str,
) -> Result<(), OutputError> {
    let layer = match shades.is_color() {
        true => "",
        false => shades.layer().name(),
    };
    let texts = [
        ("Title", title),
        ("Software", SOFTWARE),
        (LAYER_KEYWORD, layer),
        (PNG_KEYWORD, preset),
    ];
    let there = texts.into_iter().filter(|(_, text)| !text.is_empty());
    let (texts, numbers): (Vec<_>, _) = (there.collect(), shades.samples(depth.most()));
    let written = png::write(
        to,
        shades.size(),
        depth,
        &numbers,
        shades.is_color(),
        shades.ppi(),
        &texts,
    );
    written.map_err(|e| OutputError::encode("PNG", e))
}
