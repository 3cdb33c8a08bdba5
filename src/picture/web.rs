//! JPEG and WebP for the web: 8 bits per channel. They carry no preset.

use std::io::Write;

use image::codecs::jpeg::{JpegEncoder, PixelDensity};
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::picture::error::OutputError;
use crate::picture::layer::Shades;

/// Writes a layer as JPEG; the quality is from 1 to 100.
///
/// # Errors
/// The disk is full, a side is too long for the format, or the layer has alpha.
pub fn write_jpeg(to: &mut dyn Write, shades: &Shades<'_>, quality: u8) -> Result<(), OutputError> {
    let mut encoder = JpegEncoder::new_with_quality(to, quality);
    if let Some(ppi) = shades.ppi().and_then(|ppi| u16::try_from(ppi).ok()) {
        encoder.set_pixel_density(PixelDensity::dpi(ppi));
    }
    write(encoder, shades, "JPEG")
}

/// Writes a layer as WebP without loss.
///
/// # Errors
/// The disk is full, or a side is too long for the format.
pub fn write_webp(to: &mut dyn Write, shades: &Shades<'_>) -> Result<(), OutputError> {
    write(WebPEncoder::new_lossless(to), shades, "WebP")
}

fn write(
    encoder: impl ImageEncoder,
    shades: &Shades<'_>,
    format: &'static str,
) -> Result<(), OutputError> {
    let [width, height] = shades.size();
    let color = match (shades.is_grey(), shades.has_alpha()) {
        (true, _) => ExtendedColorType::L8,
        (_, false) => ExtendedColorType::Rgb8,
        (_, true) => ExtendedColorType::Rgba8,
    };
    let written = encoder.write_image(&shades.bytes(), width, height, color);
    written.map_err(|e| OutputError::encode(format, e))
}
