//! PNG with 8 or 16 bits per channel, and with its preset, title and program as text.

use std::io::Write;

use png::EncodingError;

use crate::picture::SOFTWARE;
use crate::picture::error::OutputError;
use crate::picture::layer::{Layer, Shades};
use crate::preset::PNG_KEYWORD;
use crate::raster::png::{self as file, BitDepth};

/// Keyword of the text that names the layer, if it is not the colours.
pub const LAYER_KEYWORD: &str = "conemarch layer";

/// What a PNG tells beside its pixels.
#[derive(Clone, Copy, Debug)]
pub struct PngHead<'a> {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The layer.
    pub layer: Layer,
    /// Whether alpha follows the numbers of the layer.
    pub alpha: bool,
    /// Bits of a channel.
    pub depth: BitDepth,
    /// Pixels per inch.
    pub ppi: Option<u32>,
    /// The title of the plan.
    pub title: &'a str,
    /// The text of the plan that it was rendered from.
    pub preset: &'a str,
}

impl PngHead<'_> {
    /// Numbers of a pixel.
    fn channels(&self) -> usize {
        self.layer.facts().channels + usize::from(self.alpha)
    }

    /// Bytes of a row of pixels.
    pub fn row_bytes(&self) -> usize {
        let wide = usize::from(self.depth == BitDepth::Sixteen);
        (self.size[0] as usize * self.channels()) << wide
    }
}

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
    let head = PngHead {
        size: shades.size(),
        layer: shades.layer(),
        alpha: shades.has_alpha(),
        depth,
        ppi: shades.ppi(),
        title,
        preset,
    };
    write_png_rows(to, &head, [Ok(shades.rows(depth))])
}

/// Writes a PNG from parts of its rows, in order. Each is what [`Shades::rows`] makes of a part as
/// wide as the picture.
///
/// # Errors
/// A part fails, or the disk is full.
pub fn write_png_rows<E: From<OutputError>>(
    to: &mut dyn Write,
    head: &PngHead<'_>,
    parts: impl IntoIterator<Item = Result<Vec<u8>, E>>,
) -> Result<(), E> {
    let layer = match head.layer {
        Layer::Color => "",
        other => other.name(),
    };
    let texts = [
        ("Title", head.title),
        ("Software", SOFTWARE),
        (LAYER_KEYWORD, layer),
        (PNG_KEYWORD, head.preset),
    ];
    let there = texts.into_iter().filter(|(_, text)| !text.is_empty());
    let texts: Vec<_> = there.collect();
    let of_file = file::Head {
        size: head.size,
        depth: head.depth,
        channels: head.channels(),
        is_light: head.layer == Layer::Color,
        ppi: head.ppi,
        texts: &texts,
    };
    // The encoder's errors and those of the parts go the same way.
    let parts = parts.into_iter().map(|part| part.map_err(Fault::Part));
    let written: Result<(), Fault<E>> = file::write_rows(to, &of_file, parts);
    written.map_err(|fault| match fault {
        Fault::Part(e) => e,
        Fault::Encoder(e) => OutputError::encode("PNG", e).into(),
    })
}

/// Why a PNG cannot be written: a part of it failed, or the encoder.
enum Fault<E> {
    Part(E),
    Encoder(EncodingError),
}

impl<E> From<EncodingError> for Fault<E> {
    fn from(e: EncodingError) -> Self {
        Self::Encoder(e)
    }
}
