//! A picture that colours a height surface. Twin: `wgsl/heightfield/texture.wgsl`.
//!
//! The picture is stretched over the whole map, once for each tile, whatever its own size. If it
//! is as large as the map, the middle of each texel lies on a sample. A map that does not wrap
//! ends at its last samples, so that the outer halves of their texels are not visible. Texels are
//! sRGB of 8 bits, and become linear before they are interpolated. Distant texels are not
//! averaged; render larger and scale down instead.

use std::io::ErrorKind;
use std::path::Path;

use glam::DVec3;
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};

use crate::base::{shader::Module, srgb::linear};
use crate::heightfield::heights::brought_in;
use crate::heightfield::{HeightSurface, Patches};
use crate::raster::open::{check_size, open};
use crate::raster::texels::bilinear;
use crate::wgsl;

/// A picture over a height surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    size: [u32; 2],
    /// Red, green and blue of 8 bits, row by row.
    texels: Vec<[u8; 3]>,
    /// Whether the file has transparent texels.
    transparent: bool,
}

impl Texture {
    /// Reads a PNG, JPEG or WebP. Numbers are taken as they stand: neither a colour profile nor
    /// an orientation is applied, and 16 bits are rounded to 8.
    ///
    /// # Errors
    /// The file cannot be read, is no such picture, is broken, or is too large. The text has the
    /// file's name.
    pub fn read(path: &Path) -> Result<Self, String> {
        let image = decode(path).map_err(|why| format!("{}: {why}", path.display()))?;
        let transparent =
            image.color().has_alpha() && image.to_rgba16().pixels().any(|p| p.0[3] != u16::MAX);
        let image = image.into_rgb8();
        Ok(Self {
            size: image.dimensions().into(),
            texels: image.pixels().map(|p| p.0).collect(),
            transparent,
        })
    }

    /// What was left out of the file, if there is anything to tell.
    pub fn note(&self) -> Option<&'static str> {
        self.transparent.then_some(
            "is transparent in places; its alpha is ignored, and the colours under it show",
        )
    }

    /// Linear red, green and blue at (u, v) in 0..=1 of a cell of the domain.
    pub fn at(&self, surface: &HeightSurface, cell: [i32; 2], uv: [f64; 2]) -> DVec3 {
        let own = surface.tile_cell(cell);
        let heights = surface.heights();
        let place = |a: usize| {
            let (n, round) = (heights.size()[a], heights.wrap()[a]);
            // A sample is the middle of its texel. A box is a sample, and so is the only cell of
            // an axis with one sample.
            let is_one = surface.patches() == Patches::Boxes || n == 1 && !round;
            let middle = if is_one { 0.0 } else { 0.5 };
            let share = (f64::from(own[a]) + uv[a] + middle) / f64::from(n);
            share * f64::from(self.size[a]) - 0.5
        };
        let index = |a: usize, i: i64| brought_in(i, self.size[a], heights.wrap()[a]) as usize;
        bilinear(place(0), place(1), |column, row| {
            let (column, row) = (index(0, column), index(1, row));
            let [r, g, b] = self.texels[row * self.size[0] as usize + column].map(f64::from);
            linear(DVec3::new(r, g, b) / 255.0)
        })
    }

    /// The WGSL module.
    pub fn module() -> Module {
        wgsl!("heightfield/texture.wgsl")
    }

    /// What the shaders read: columns, rows, then texels with red in the low byte.
    pub fn bytes(&self) -> Vec<u8> {
        let texel = |[r, g, b]: &[u8; 3]| u32::from_le_bytes([*r, *g, *b, 255]);
        let numbers = self.size.into_iter().chain(self.texels.iter().map(texel));
        let numbers: Vec<u32> = numbers.collect();
        bytemuck::cast_slice(&numbers).to_vec()
    }
}

/// The picture in a file.
fn decode(path: &Path) -> Result<DynamicImage, String> {
    let opened = open(path)?;
    let mut reader = ImageReader::new(opened.file);
    // The size is checked below.
    reader.no_limits();
    let reader = reader.with_guessed_format().map_err(|e| e.to_string())?;
    let name = match reader.format() {
        Some(ImageFormat::Png) => "PNG",
        Some(ImageFormat::Jpeg) => "JPEG",
        Some(ImageFormat::WebP) => "WebP",
        _ => return Err("is no PNG, JPEG or WebP; save it as one of these".into()),
    };
    let broken = |e: ImageError| match e {
        ImageError::IoError(e) if e.kind() == ErrorKind::UnexpectedEof => {
            format!("is a {name} that ends before its end; fetch or save it again")
        }
        e => format!("is a broken {name}: {e}; fetch or save it again"),
    };
    let decoder = reader.into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into())?;
    DynamicImage::from_decoder(decoder).map_err(broken)
}
