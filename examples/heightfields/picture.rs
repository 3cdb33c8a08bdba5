//! Small pictures, and several of them as one.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use png::{ColorType, Compression, Decoder, Encoder, Filter, Transformations};

/// Pixels between pictures: white, as the page is.
const GAP: usize = 6;

/// Pixels of sRGB, row by row.
pub struct Picture {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Red, green, blue.
    pub pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// A picture of a function of column and row.
    pub fn of(size: [usize; 2], color: impl Fn(usize, usize) -> [u8; 3]) -> Self {
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        Self {
            size,
            pixels: places.map(|(x, y)| color(x, y)).collect(),
        }
    }

    /// Reads a PNG in colour.
    pub fn read(path: &Path) -> Result<Self> {
        let name = || path.display().to_string();
        let file = File::open(path).with_context(name)?;
        let mut decoder = Decoder::new(BufReader::new(file));
        decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
        let mut reader = decoder.read_info().with_context(name)?;
        let mut bytes = vec![0; reader.output_buffer_size().with_context(name)?];
        let info = reader.next_frame(&mut bytes).with_context(name)?;
        ensure!(info.color_type == ColorType::Rgb, "{}: no colours", name());
        Ok(Self {
            size: [info.width as usize, info.height as usize],
            pixels: bytes.as_chunks::<3>().0.to_vec(),
        })
    }

    /// Pictures in rows of so many, each place as large as the largest.
    pub fn grid(pictures: &[Self], columns: usize) -> Self {
        let columns = columns.clamp(1, pictures.len().max(1));
        let rows = pictures.len().div_ceil(columns);
        let place = [0, 1].map(|a| pictures.iter().map(|p| p.size[a]).max().unwrap_or(0) + GAP);
        let size = [columns * place[0] - GAP, rows * place[1] - GAP];
        Self::of(size, |x, y| {
            let (i, j) = (x / place[0], y / place[1]);
            let (x, y) = (x % place[0], y % place[1]);
            let own = pictures.get(j * columns + i);
            let inside = own.filter(|p| x < p.size[0] && y < p.size[1]);
            inside.map_or([255; 3], |p| p.pixels[y * p.size[0] + x])
        })
    }

    /// Writes a PNG, as small as it goes.
    pub fn write(&self, path: &Path) -> Result<()> {
        let name = || path.display().to_string();
        let file = BufWriter::new(File::create(path).with_context(name)?);
        let [w, h] = self.size.map(|n| n as u32);
        let mut encoder = Encoder::new(file, w, h);
        encoder.set_color(ColorType::Rgb);
        encoder.set_compression(Compression::High);
        encoder.set_filter(Filter::Adaptive);
        let mut writer = encoder.write_header().with_context(name)?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish().with_context(name)
    }
}
