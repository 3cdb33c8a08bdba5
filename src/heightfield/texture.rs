//! A picture that colours a relief. Twin: `wgsl/heightfield/texture.wgsl`.
//!
//! It is stretched over the whole map, once to each tile, whatever its own size: a picture as
//! large as the map has a texel for each sample, whose middle lies on it. A map that ends does
//! so at its last samples, and the outer halves of their texels are not seen. Texels are sRGB
//! of 8 bits and become linear before they are interpolated. Far away none are averaged: render
//! larger and scale down.

use std::path::Path;

use glam::DVec3;

use crate::base::shader::Module;
use crate::base::srgb::linear;
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::heights::{Patches, brought_in};
use crate::heightfield::raster::open::{Format, open};
use crate::heightfield::raster::png;
use crate::wgsl;

/// A picture over a relief.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    size: [u32; 2],
    /// Red, green and blue of 8 bits, row by row.
    texels: Vec<[u8; 3]>,
    /// Whether alpha was left out.
    transparent: bool,
}

impl Texture {
    /// Reads a PNG, grey or colour, of 8 or 16 bits.
    ///
    /// # Errors
    /// In words, with the file's name: it is none, broken, or too large.
    pub fn read(path: &Path) -> Result<Self, String> {
        let picture = || {
            let opened = open(path)?;
            if opened.format != Format::Png {
                return Err("is no PNG, which colours are read from; save it as one".into());
            }
            png::read(opened.file, 3, "")
        };
        let pixels = picture().map_err(|why: String| format!("{}: {why}", path.display()))?;
        let most = u32::from(pixels.most);
        let eight = |n: u16| ((u32::from(n) * 255 + most / 2) / most) as u8;
        let texel = |own: &[u16]| match *own {
            [r, g, b] => [r, g, b].map(eight),
            // Grey, with or without alpha.
            _ => [eight(own[0]); 3],
        };
        Ok(Self {
            size: pixels.size,
            texels: pixels
                .numbers
                .chunks_exact(pixels.kept)
                .map(texel)
                .collect(),
            transparent: !pixels.is_opaque,
        })
    }

    /// What was left out of the file, if anybody might wonder.
    pub fn note(&self) -> Option<&'static str> {
        self.transparent
            .then_some("is transparent in places: alpha is left out, and what it hides counts")
    }

    /// Linear red, green and blue at (u, v) in 0..=1 of a cell of the domain.
    pub fn at(&self, relief: &HeightSurface, cell: [i32; 2], uv: [f64; 2]) -> DVec3 {
        let own = relief.tile_cell(cell);
        let heights = relief.heights();
        let place = |a: usize| {
            let (n, round) = (heights.size()[a], heights.wrap()[a]);
            // A sample is the middle of its texel: a box is one, and so is the one cell of an
            // axis with a single sample.
            let is_one = relief.patches() == Patches::Boxes || n == 1 && !round;
            let middle = if is_one { 0.0 } else { 0.5 };
            let share = (f64::from(own[a]) + uv[a] + middle) / f64::from(n);
            share * f64::from(self.size[a]) - 0.5
        };
        let (x, y) = (place(0), place(1));
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let index = |a: usize, i: f64, step: i64| {
            brought_in(i.floor() as i64 + step, self.size[a], heights.wrap()[a]) as usize
        };
        let texel = |dx: i64, dy: i64| {
            let (column, row) = (index(0, x, dx), index(1, y, dy));
            let [r, g, b] = self.texels[row * self.size[0] as usize + column].map(f64::from);
            linear(DVec3::new(r, g, b) / 255.0)
        };
        let low = texel(0, 0).lerp(texel(1, 0), fx);
        low.lerp(texel(0, 1).lerp(texel(1, 1), fx), fy)
    }

    /// The module to join.
    pub fn module() -> Module {
        wgsl!("heightfield/texture.wgsl")
    }

    /// Bytes to bind: columns, rows, and texels with red in the low byte.
    pub fn buffer(&self) -> (&'static str, Vec<u8>) {
        let texel = |[r, g, b]: &[u8; 3]| u32::from_le_bytes([*r, *g, *b, 255]);
        let numbers = self.size.into_iter().chain(self.texels.iter().map(texel));
        let numbers: Vec<u32> = numbers.collect();
        ("texels", bytemuck::cast_slice(&numbers).to_vec())
    }
}
