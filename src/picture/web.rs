//! JPEG and WebP for the web: 8 bits per channel. They carry no preset, and tell title, program,
//! density and colour space by EXIF (CIPA DC-008, 4.6).

use std::io::{Cursor, Write};

use exif::experimental::Writer;
use exif::{Error, Field, In, Rational, Tag, Value};
use image::codecs::jpeg::{JpegEncoder, PixelDensity};
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::picture::SOFTWARE;
use crate::picture::error::OutputError;
use crate::picture::layer::{Layer, Shades};

/// Writes a layer as JPEG; the quality is from 1 to 100.
///
/// # Errors
/// The disk is full, a side is too long for the format, or the layer has alpha.
pub fn write_jpeg(
    to: &mut dyn Write,
    shades: &Shades<'_>,
    quality: u8,
    title: &str,
) -> Result<(), OutputError> {
    let mut encoder = JpegEncoder::new_with_quality(to, quality);
    if let Some(ppi) = shades.ppi().and_then(|ppi| u16::try_from(ppi).ok()) {
        encoder.set_pixel_density(PixelDensity::dpi(ppi));
    }
    write(encoder, shades, title, "JPEG")
}

/// Writes a layer as WebP without loss.
///
/// # Errors
/// The disk is full, or a side is too long for the format.
pub fn write_webp(to: &mut dyn Write, shades: &Shades<'_>, title: &str) -> Result<(), OutputError> {
    write(WebPEncoder::new_lossless(to), shades, title, "WebP")
}

fn write(
    mut encoder: impl ImageEncoder,
    shades: &Shades<'_>,
    title: &str,
    format: &'static str,
) -> Result<(), OutputError> {
    let [width, height] = shades.size();
    let color = match (shades.is_grey(), shades.has_alpha()) {
        (true, _) => ExtendedColorType::L8,
        (_, false) => ExtendedColorType::Rgb8,
        (_, true) => ExtendedColorType::Rgba8,
    };
    let exif = exif(shades, title).map_err(|e| OutputError::encode(format, e))?;
    let told = encoder.set_exif_metadata(exif);
    told.map_err(|e| OutputError::encode(format, e))?;
    let written = encoder.write_image(&shades.bytes(), width, height, color);
    written.map_err(|e| OutputError::encode(format, e))
}

/// What a file tells besides its pixels.
fn exif(shades: &Shades<'_>, title: &str) -> Result<Vec<u8>, Error> {
    const INCH: u16 = 2;
    const SRGB: u16 = 1;
    let text = |text: &str| Value::Ascii(vec![text.as_bytes().to_vec()]);
    let mut told = vec![(Tag::Software, text(SOFTWARE))];
    if !title.is_empty() {
        told.push((Tag::ImageDescription, text(title)));
    }
    if let Some(ppi) = shades.ppi() {
        let density = Value::Rational(vec![Rational { num: ppi, denom: 1 }]);
        told.push((Tag::XResolution, density.clone()));
        told.push((Tag::YResolution, density));
        told.push((Tag::ResolutionUnit, Value::Short(vec![INCH])));
    }
    if shades.layer() == Layer::Color {
        told.push((Tag::ColorSpace, Value::Short(vec![SRGB])));
    }
    let fields = told.into_iter().map(|(tag, value)| Field {
        tag,
        ifd_num: In::PRIMARY,
        value,
    });
    let fields: Vec<_> = fields.collect();
    let mut writer = Writer::new();
    for field in &fields {
        writer.push_field(field);
    }
    let mut bytes = Cursor::new(Vec::new());
    writer.write(&mut bytes, true)?;
    Ok(bytes.into_inner())
}
