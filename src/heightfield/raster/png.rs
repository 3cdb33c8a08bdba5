//! PNG as whole numbers: grey or colour, with or without alpha, 1 to 16 bits.
//!
//! Palettes and fewer than 8 bits are expanded. Numbers are taken as they stand:
//! neither gamma nor a colour profile is applied, because heights are not light.

use std::io::{BufRead, Seek, Write};

use png::{ColorType, Decoder, DecodingError, Encoder, Reader, Transformations};

use crate::heightfield::heights::MOST_SAMPLES;
use crate::heightfield::raster::open::check_size;

/// Longest text that is read from a file: far more than any description needs.
const MOST_TEXT: usize = 1 << 16;

/// The pixels of a file, and what is known of the channels that were left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Columns and rows.
    pub size: [u32; 2],
    /// How many channels are kept, the first ones of the file.
    pub kept_channels: usize,
    /// Channels of the file: 1 grey, 2 with alpha, 3 colour, 4 with alpha.
    pub channels: usize,
    /// The largest number: 255 or 65535.
    pub most: u16,
    /// Numbers of the kept channels, pixel by pixel, row by row.
    pub numbers: Vec<u16>,
    /// Whether red, green and blue are the same everywhere.
    pub is_grey: bool,
    /// Whether alpha is full everywhere.
    pub is_opaque: bool,
    /// The text under the keyword that was asked for.
    pub text: Option<String>,
}

impl Pixels {
    /// Pixels that keep all their channels, with no text.
    pub fn new(size: [u32; 2], channels: usize, most: u16, numbers: Vec<u16>) -> Self {
        Self {
            size,
            kept_channels: channels,
            channels,
            most,
            numbers,
            is_grey: true,
            is_opaque: true,
            text: None,
        }
    }

    /// One of the kept channels.
    pub fn channel(&self, i: usize) -> impl Iterator<Item = u16> + '_ {
        self.numbers
            .iter()
            .skip(i)
            .step_by(self.kept_channels)
            .copied()
    }
}

/// Reads a file, keeping at most some channels of each pixel.
///
/// # Errors
/// In words: broken, cut short, or too large.
pub fn read(from: impl BufRead + Seek, most_kept: usize, keyword: &str) -> Result<Pixels, String> {
    let mut decoder = Decoder::new(from);
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|e| broken(&e))?;
    let (width, height) = reader.info().size();
    let size = check_size(width.into(), height.into(), MOST_SAMPLES)?;
    let (color, depth) = reader.output_color_type();
    let bytes = usize::from(depth as u8).div_ceil(8);
    let channels = color.samples();
    let kept_channels = channels.min(most_kept);
    let most = if bytes == 2 { u16::MAX } else { 255 };
    let numbers = Vec::with_capacity(size[0] as usize * size[1] as usize * kept_channels);
    let mut pixels = Pixels {
        kept_channels,
        text: text(&reader, keyword),
        ..Pixels::new(size, channels, most, numbers)
    };
    let has_alpha = matches!(color, ColorType::GrayscaleAlpha | ColorType::Rgba);
    let mut take = |row: &[u8]| {
        let number = |b: &[u8]| match *b {
            [high, low] => u16::from_be_bytes([high, low]),
            [low] => u16::from(low),
            _ => 0,
        };
        for pixel in row.chunks_exact(bytes * channels) {
            let part = |i: usize| number(&pixel[i * bytes..(i + 1) * bytes]);
            pixels.numbers.extend((0..kept_channels).map(part));
            if channels >= 3 {
                pixels.is_grey &= part(0) == part(1) && part(1) == part(2);
            }
            if has_alpha {
                pixels.is_opaque &= part(channels - 1) == pixels.most;
            }
        }
    };
    if reader.info().interlaced {
        // Its rows come in seven passes; only the whole is in order.
        let whole = reader.output_buffer_size();
        let line = reader.output_line_size(width);
        let (Some(whole), Some(line)) = (whole, line) else {
            return Err("is larger than memory".into());
        };
        let mut all = vec![0; whole];
        reader.next_frame(&mut all).map_err(|e| broken(&e))?;
        all.chunks_exact(line).for_each(take);
    } else {
        for _ in 0..height {
            let row = reader.next_row().map_err(|e| broken(&e))?;
            take(
                row.ok_or("ends before its last row; fetch or save it again")?
                    .data(),
            );
        }
    }
    // What follows the last pixel tells whether the file was cut there.
    reader.finish().map_err(|e| broken(&e))?;
    Ok(pixels)
}

/// The text under a keyword, from the head of a file alone; `None` if there is none, or
/// no head.
pub fn text_in(from: impl BufRead + Seek, keyword: &str) -> Option<String> {
    let reader = Decoder::new(from).read_info().ok()?;
    text(&reader, keyword)
}

fn broken(e: &DecodingError) -> String {
    match e {
        DecodingError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
            "is a PNG that ends before its end; fetch or save it again".into()
        }
        _ => format!("is a broken PNG: {e}; fetch or save it again"),
    }
}

/// The text under a keyword; another program may have saved it compressed.
fn text<R: BufRead + Seek>(reader: &Reader<R>, keyword: &str) -> Option<String> {
    let info = reader.info();
    let plain = info.uncompressed_latin1_text.iter();
    if let Some(chunk) = plain.clone().find(|c| c.keyword == keyword) {
        return Some(chunk.text.clone());
    }
    let packed = &mut info.compressed_latin1_text.clone();
    if let Some(chunk) = packed.iter_mut().find(|c| c.keyword == keyword) {
        chunk.decompress_text_with_limit(MOST_TEXT).ok()?;
        return chunk.get_text().ok();
    }
    let unicode = &mut info.utf8_text.clone();
    let chunk = unicode.iter_mut().find(|c| c.keyword == keyword)?;
    chunk.decompress_text_with_limit(MOST_TEXT).ok()?;
    chunk.get_text().ok()
}

/// Writes pixels that keep all their channels, with the text under a keyword.
///
/// # Errors
/// In words: what the encoder or the writer said.
pub fn write(to: impl Write, pixels: &Pixels, keyword: &str) -> Result<(), String> {
    let mut encoder = Encoder::new(to, pixels.size[0], pixels.size[1]);
    encoder.set_color(match pixels.kept_channels {
        1 => ColorType::Grayscale,
        2 => ColorType::GrayscaleAlpha,
        3 => ColorType::Rgb,
        _ => ColorType::Rgba,
    });
    let wide = pixels.most > 255;
    encoder.set_depth(if wide {
        png::BitDepth::Sixteen
    } else {
        png::BitDepth::Eight
    });
    let numbers = pixels.numbers.iter();
    let bytes: Vec<u8> = match wide {
        true => numbers.flat_map(|n| n.to_be_bytes()).collect(),
        false => numbers.map(|n| *n as u8).collect(),
    };
    if let Some(text) = &pixels.text {
        let added = encoder.add_text_chunk(keyword.into(), text.clone());
        added.map_err(|e| e.to_string())?;
    }
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&bytes)?;
        writer.finish()
    });
    written.map_err(|e| e.to_string())
}
