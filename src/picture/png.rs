//! PNG with 8 or 16 bits per channel, and with its preset, title and program as text.

use std::io::Write;

use png::{ColorType, Encoder, EncodingError, SrgbRenderingIntent};

use crate::picture::SOFTWARE;
use crate::picture::error::OutputError;
use crate::picture::layer::Shades;
use crate::preset::PNG_KEYWORD;

/// Bits of one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BitDepth {
    /// 0..255.
    #[default]
    Eight,
    /// 0..65535.
    Sixteen,
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
    let encode = || -> Result<(), EncodingError> {
        let [width, height] = shades.size();
        let mut encoder = Encoder::new(to, width, height);
        encoder.set_color(if shades.is_grey() {
            ColorType::Grayscale
        } else {
            ColorType::Rgb
        });
        if shades.is_color() {
            encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
        }
        let texts = [
            ("Title", title),
            ("Software", SOFTWARE),
            (PNG_KEYWORD, preset),
        ];
        for (keyword, text) in texts.into_iter().filter(|(_, text)| !text.is_empty()) {
            // More programs know tEXt than iTXt, but it has no other letters.
            if text.is_ascii() {
                encoder.add_text_chunk(keyword.into(), text.into())?;
            } else {
                encoder.add_itxt_chunk(keyword.into(), text.into())?;
            }
        }
        let bytes: Vec<u8> = match depth {
            BitDepth::Eight => {
                encoder.set_depth(png::BitDepth::Eight);
                shades.bytes()
            }
            BitDepth::Sixteen => {
                encoder.set_depth(png::BitDepth::Sixteen);
                let samples = shades.samples(u16::MAX);
                samples.into_iter().flat_map(u16::to_be_bytes).collect()
            }
        };
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&bytes)?;
        writer.finish()
    };
    encode().map_err(|e| OutputError::encode("PNG", e))
}
