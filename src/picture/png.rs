//! PNG: 8 or 16 bits, sRGB, with the preset inside.

use std::io::Write;

use png::{ColorType, Encoder, SrgbRenderingIntent};

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

/// Writes a layer as PNG. `preset` is the text of the plan as it was rendered.
///
/// # Errors
/// The disk is full.
pub fn write_png(
    to: &mut dyn Write,
    shades: &Shades<'_>,
    depth: BitDepth,
    preset: &str,
) -> Result<(), OutputError> {
    encode(to, shades, depth, preset).map_err(|e| OutputError::Encode {
        format: "PNG",
        why: e.to_string(),
    })
}

fn encode(
    to: &mut dyn Write,
    shades: &Shades<'_>,
    depth: BitDepth,
    preset: &str,
) -> Result<(), png::EncodingError> {
    let [width, height] = shades.size();
    let mut encoder = Encoder::new(to, width, height);
    encoder.set_color(if shades.is_grey() {
        ColorType::Grayscale
    } else {
        ColorType::Rgb
    });
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    encoder.add_itxt_chunk(PNG_KEYWORD.into(), preset.into())?;
    let bytes: Vec<u8> = match depth {
        BitDepth::Eight => {
            encoder.set_depth(png::BitDepth::Eight);
            let samples = shades.samples(u16::from(u8::MAX));
            samples.into_iter().map(|s| s.to_le_bytes()[0]).collect()
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
}
