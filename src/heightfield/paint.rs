//! The colours of a height surface: by its height, by the width of a map's cones, or of a
//! picture. Twins: `wgsl/heightfield/paint.wgsl`, `paint_height.wgsl`.

use std::sync::Arc;

use crate::base::array::SceneArray;
use crate::base::shader::Module;
use crate::heightfield::conemap::generate::Generator;
use crate::heightfield::{ConeMap, HeightSurface, Patches, texture::Texture};
use crate::wgsl;

/// What may pick the hue. `brute` is missing because its map is that of `exact`.
pub const PAINTS: &[(&str, Option<Generator>)] = &{
    let mut paints = [("height", None); Generator::ALL.len()];
    let (mut from, mut to) = (0, 1);
    while from < Generator::WORDS.len() {
        let (name, generator) = Generator::WORDS[from];
        if !matches!(generator, Generator::Brute) {
            paints[to] = (name, Some(generator));
            to += 1;
        }
        from += 1;
    }
    paints
};

/// A number from 0 to 1 for each place of a cone map.
#[derive(Clone, Debug, PartialEq)]
pub struct Paint {
    size: [u32; 2],
    over_cells: bool,
    values: Vec<f32>,
}

impl Paint {
    /// The square roots of a map's ratios, or of the mean of four cones. 1 is a cone that widens
    /// by the length of the map over the whole height, or by more.
    pub fn new(map: &ConeMap) -> Self {
        let places = map.size[0] as usize * map.size[1] as usize;
        let channels = map.ratios.len() / places;
        let widest = f64::from(map.size[0].max(map.size[1]));
        let value = |cones: &[f64]| {
            let mean = cones.iter().sum::<f64>() / cones.len() as f64;
            (mean / widest).min(1.0).sqrt() as f32
        };
        Self {
            size: map.size,
            over_cells: map.kind.over_cells(),
            values: map.ratios.chunks(channels).map(value).collect(),
        }
    }

    /// The number at (u, v) in 0..=1 of a cell of the domain: that of the cell, or of the nearest
    /// sample.
    pub fn at(&self, surface: &HeightSurface, cell: [i32; 2], uv: [f64; 2]) -> f64 {
        if self.over_cells {
            return f64::from(self.values[surface.number(cell) as usize]);
        }
        let own = surface.tile_cell(cell);
        // A box has one sample, a patch one in each corner.
        let near = |a: usize| u32::from(surface.patches() == Patches::Bilinear && uv[a] >= 0.5);
        let [x, y] = [0, 1].map(|a| surface.heights().index(a, i64::from(own[a] + near(a))));
        f64::from(self.values[(y * self.size[0] + x) as usize])
    }

    /// Its numbers as bytes.
    fn bytes(&self) -> Vec<u8> {
        bytemuck::cast_slice(&self.values).to_vec()
    }
}

/// What colours a height surface.
#[derive(Clone, Debug)]
pub enum Colors {
    /// The height picks the hue.
    Height,
    /// The width of cones picks the hue.
    Cones(Arc<Paint>),
    /// A picture gives the colours.
    Texture(Arc<Texture>),
}

impl Colors {
    /// The WGSL module.
    pub fn module(&self) -> Module {
        match self {
            Self::Height => wgsl!("heightfield/paint_height.wgsl"),
            Self::Cones(paint) => wgsl!(
                "heightfield/paint.wgsl",
                "PAINT_OVER_CELLS" = f64::from(u8::from(paint.over_cells)),
            ),
            Self::Texture(_) => Texture::module(),
        }
    }

    /// What the shaders read, if there is anything.
    pub fn array(&self) -> Option<SceneArray> {
        match self {
            Self::Height => None,
            Self::Cones(paint) => Some(SceneArray::new("paint", paint, Paint::bytes)),
            Self::Texture(picture) => Some(SceneArray::new("texels", picture, Texture::bytes)),
        }
    }
}
