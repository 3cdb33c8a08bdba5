//! PNG as whole numbers: grey or colour, with or without alpha, 1 to 16 bits.
//!
//! Palettes and fewer than 8 bits are expanded. Numbers are taken as they stand:
//! neither gamma nor a colour profile is applied, because heights are not light.

use std::io::{BufRead, Seek, Write};

use png::{
    ColorType, Decoder, DecodingError, Encoder, EncodingError, PixelDimensions,
    SrgbRenderingIntent, Transformations, Unit,
};

use crate::raster::open::check_size;

/// Bits of a channel, whose whole numbers stand for 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BitDepth {
    /// 0 to 255.
    #[default]
    Eight = 8,
    /// 0 to 65535.
    Sixteen = 16,
}

impl BitDepth {
    /// The number that stands for 1.
    pub fn most(self) -> u16 {
        match self {
            Self::Eight => u8::MAX.into(),
            Self::Sixteen => u16::MAX,
        }
    }
}

/// The pixels of a file, and what is known of the channels that were left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Columns and rows.
    pub size: [u32; 2],
    /// How many channels are kept, the first ones of the file.
    pub kept_channels: usize,
    /// Channels of the file: 1 grey, 2 with alpha, 3 colour, 4 with alpha.
    pub channels: usize,
    /// Bits of each number.
    pub depth: BitDepth,
    /// Numbers of the kept channels, pixel by pixel, row by row.
    pub numbers: Vec<u16>,
    /// Whether red, green and blue are the same everywhere.
    pub is_grey: bool,
    /// Whether alpha is full everywhere.
    pub is_opaque: bool,
}

impl Pixels {
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
pub fn read(from: impl BufRead + Seek, most_kept: usize) -> Result<Pixels, String> {
    let mut decoder = Decoder::new(from);
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|e| broken(&e))?;
    let (width, height) = reader.info().size();
    let size = check_size(width.into(), height.into())?;
    let (color, depth) = reader.output_color_type();
    let bytes = usize::from(depth as u8).div_ceil(8);
    let channels = color.samples();
    let kept_channels = channels.min(most_kept);
    let mut pixels = Pixels {
        size,
        kept_channels,
        channels,
        depth: match bytes {
            1 => BitDepth::Eight,
            _ => BitDepth::Sixteen,
        },
        numbers: Vec::with_capacity(size[0] as usize * size[1] as usize * kept_channels),
        is_grey: true,
        is_opaque: true,
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
                pixels.is_opaque &= part(channels - 1) == pixels.depth.most();
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

fn broken(e: &DecodingError) -> String {
    match e {
        DecodingError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
            "is a PNG that ends before its end; fetch or save it again".into()
        }
        _ => format!("is a broken PNG: {e}; fetch or save it again"),
    }
}

/// What stands in the head of a file that is written.
#[derive(Clone, Copy, Debug)]
pub struct Head<'a> {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Bits of a channel.
    pub depth: BitDepth,
    /// Numbers per pixel: 1 grey, 2 with alpha, 3 colour, 4 with alpha.
    pub channels: usize,
    /// Whether the numbers are sRGB.
    pub is_light: bool,
    /// How many pixels there are to an inch.
    pub ppi: Option<u32>,
    /// Texts by their keywords.
    pub texts: &'a [(&'a str, &'a str)],
}

/// Compressed bytes in a chunk of a file, so that one of any height takes little memory.
const CHUNK: usize = 1 << 20;

/// Writes a file from parts of its rows, each the bytes of whole rows in order.
///
/// # Errors
/// A part fails, or what the encoder or the writer said.
pub fn write_rows<E: From<EncodingError>>(
    to: impl Write,
    head: &Head<'_>,
    parts: impl IntoIterator<Item = Result<Vec<u8>, E>>,
) -> Result<(), E> {
    let [width, height] = head.size;
    let mut encoder = Encoder::new(to, width, height);
    encoder.set_color(match head.channels {
        1 => ColorType::Grayscale,
        2 => ColorType::GrayscaleAlpha,
        3 => ColorType::Rgb,
        _ => ColorType::Rgba,
    });
    if head.depth == BitDepth::Sixteen {
        encoder.set_depth(png::BitDepth::Sixteen);
    }
    if head.is_light {
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    }
    encoder.set_pixel_dims(head.ppi.map(|ppi| {
        let per_metre = (f64::from(ppi) / 0.0254).round() as u32;
        PixelDimensions {
            xppu: per_metre,
            yppu: per_metre,
            unit: Unit::Meter,
        }
    }));
    for (keyword, text) in head.texts {
        // More programs know tEXt than iTXt, but it has no other letters.
        if text.is_ascii() {
            encoder.add_text_chunk((*keyword).into(), (*text).into())?;
        } else {
            encoder.add_itxt_chunk((*keyword).into(), (*text).into())?;
        }
    }
    let mut writer = encoder.write_header()?;
    let mut rows = writer.stream_writer_with_size(CHUNK)?;
    for part in parts {
        rows.write_all(&part?).map_err(EncodingError::from)?;
    }
    rows.finish()?;
    Ok(writer.finish()?)
}

/// Whole numbers as a file has them.
pub fn bytes(depth: BitDepth, numbers: &[u16]) -> Vec<u8> {
    match depth {
        BitDepth::Eight => numbers.iter().map(|n| *n as u8).collect(),
        BitDepth::Sixteen => numbers.iter().flat_map(|n| n.to_be_bytes()).collect(),
    }
}

/// Writes whole numbers with texts by their keywords. `is_light` says that they are sRGB.
///
/// # Errors
/// What the encoder or the writer said.
pub fn write(
    to: impl Write,
    size: [u32; 2],
    depth: BitDepth,
    numbers: &[u16],
    is_light: bool,
    texts: &[(&str, &str)],
) -> Result<(), EncodingError> {
    let places = size[0] as usize * size[1] as usize;
    let head = Head {
        size,
        depth,
        channels: numbers.len() / places.max(1),
        is_light,
        ppi: None,
        texts,
    };
    write_rows(to, &head, [Ok(bytes(depth, numbers))])
}
