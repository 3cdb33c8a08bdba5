//! A sky in a file: radiance from everywhere, in equirectangular form.
//!
//! Columns are angles about the up axis, and rows angles from it. The middle of the picture lies
//! forward on the horizon, and its right half to the right.
//!
//! Rays are sent by importance: cells of equal solid angle are sampled by the light that comes from
//! them (Walker's alias method, with the table of Vose 1991).

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::base::array::SceneArray;
use crate::raster::{hdr, texels::bilinear};

/// Cells about the up axis and along it. A cell is as wide as the sun.
const SKY_CELLS: [u32; 2] = [512, 256];
/// The share of samples that are uniform, so that no direction is forgotten.
const SKY_UNIFORM: f64 = 0.05;
/// Points along each axis of a cell that are asked for its light.
const SKY_POINTS: u32 = 3;
/// Darker light is none.
const SKY_DARK: f32 = 1e-18;
/// The brightest light of a texel. Times 1e8, the largest factors of a preset, and squared in the sums of 65 536
/// samples, it stays within an f32.
const SKY_MOST: f32 = 1e8;
/// The smallest exponent of a texel, as a number that is stored without a sign.
const SKY_EXPONENT: i32 = 64;

/// An entry of the alias table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    /// The probability that a sample stays in this cell.
    stays: f32,
    /// The cell of the others.
    alias: u32,
    /// Probability density per steradian.
    density: f32,
}

/// A sky in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    size: [u32; 2],
    /// Red and green, then blue and an exponent, each of 16 bits.
    texels: Vec<[u32; 2]>,
    cells: Vec<Cell>,
    /// Irradiance over pi, in spherical harmonics up to the second degree
    /// (Ramamoorthi and Hanrahan, An efficient representation for irradiance environment maps, 2001).
    bands: [DVec3; 9],
}

/// The harmonics of a unit vector, up to constants.
fn harmonics(n: DVec3) -> [f64; 9] {
    let DVec3 { x, y, z } = n;
    let last = [x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y];
    let [a, b, c, d, e] = last;
    [1.0, x, y, z, a, b, c, d, e]
}

/// One over the mean square of each harmonic, times the factor of its degree in irradiance over pi: 1,
/// 2/3 and 1/4.
const HARMONIC_SHARES: [f64; 9] = [
    1.0,
    2.0,
    2.0,
    2.0,
    15.0 / 4.0,
    15.0 / 4.0,
    5.0 / 16.0,
    15.0 / 4.0,
    15.0 / 16.0,
];

fn packed([r, g, b]: [f32; 3]) -> [u32; 2] {
    let most = r.max(g).max(b);
    if most < SKY_DARK {
        return [0; 2];
    }
    // The least power of 2 above the largest number.
    let exponent = f64::from(most).log2().floor() as i32 + 1;
    let share = |x: f32| {
        (f64::from(x) * 2f64.powi(16 - exponent))
            .round()
            .min(65535.0) as u32
    };
    let stored = (exponent + SKY_EXPONENT) as u32;
    [share(r) | share(g) << 16, share(b) | stored << 16]
}

fn unpacked([low, high]: [u32; 2]) -> DVec3 {
    let exponent = (high >> 16) as i32 - SKY_EXPONENT - 16;
    let [r, g, b] = [low & 0xffff, low >> 16, high & 0xffff].map(f64::from);
    DVec3::new(r, g, b) * 2f64.powi(exponent)
}

impl Sky {
    /// Reads a Radiance HDR or an OpenEXR of red, green and blue, which is twice as wide as high.
    ///
    /// # Errors
    /// The file cannot be read, is no such picture, is broken, too large, or has numbers that are
    /// no light. The text has the file's name.
    pub fn read(path: &Path) -> Result<Self, String> {
        let read = hdr::light(path).and_then(|(size, light)| Self::new(size, &light));
        read.map_err(|why| format!("{}: {why}", path.display()))
    }

    /// The sky of linear light, row by row from the zenith down.
    ///
    /// # Errors
    /// In words: it is not twice as wide as high, or a number is no light from 0 to 1e8.
    pub fn new(size: [u32; 2], light: &[[f32; 3]]) -> Result<Self, String> {
        let [w, h] = size;
        if w != 2 * h {
            return Err(format!(
                "is {w} x {h}, and a whole sky is twice as wide as high; save it in equirectangular form"
            ));
        }
        let bad = |c: &[f32; 3]| c.iter().any(|x| !(0.0..=SKY_MOST).contains(x));
        if let Some(at) = light.iter().position(bad) {
            let (x, y) = (at % w as usize, at / w as usize);
            return Err(format!(
                "has {:?} in column {x}, row {y}, and light is from 0 to {SKY_MOST:e}; save it with other numbers there, or darker with a larger look.sky_strength",
                light[at]
            ));
        }
        let mut sky = Self {
            size,
            texels: light.iter().copied().map(packed).collect(),
            cells: Vec::new(),
            bands: [DVec3::ZERO; 9],
        };
        sky.cells = alias_table(&sky.brightness());
        sky.bands = sky.spread();
        Ok(sky)
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Radiance from a direction, given to the right, forward and up.
    pub fn radiance(&self, own: DVec3) -> DVec3 {
        let [w, h] = self.size.map(f64::from);
        let down = own.truncate().length().atan2(own.z) / PI;
        let (x, y) = (turns(own) * w - 0.5, down * h - 0.5);
        bilinear(x, y, |column, row| {
            let column = column.rem_euclid(i64::from(self.size[0]));
            let row = row.clamp(0, i64::from(self.size[1]) - 1);
            self.texel(column as usize, row as usize)
        })
    }

    /// Radiance of a white wall that faces a direction, if nothing but the sky lights it.
    pub fn ambient(&self, own: DVec3) -> DVec3 {
        let parts = self.bands.iter().zip(harmonics(own));
        let sum: DVec3 = parts.map(|(band, y)| *band * y).sum();
        sum.max(DVec3::ZERO)
    }

    /// A sample of directions, and its probability density per steradian. Both pairs are from 0 to 1.
    pub fn toward(&self, cell: DVec2, pair: DVec2) -> (DVec3, f64) {
        let [w, h] = SKY_CELLS;
        let last = self.cells.len() - 1;
        let mut i = ((cell.x * self.cells.len() as f64) as usize).min(last);
        if cell.y >= f64::from(self.cells[i].stays) {
            i = self.cells[i].alias as usize;
        }
        let (x, y) = (i as u32 % w, i as u32 / w);
        let own = in_cells(
            (f64::from(x) + pair.x) / f64::from(w),
            (f64::from(y) + pair.y) / f64::from(h),
        );
        (own, f64::from(self.cells[i].density))
    }

    /// The probability density of [`Sky::toward`] in a direction.
    pub fn density(&self, own: DVec3) -> f64 {
        let [x, y] = cell_of(own);
        f64::from(self.cells[(y * SKY_CELLS[0] + x) as usize].density)
    }

    /// Irradiance over pi, in spherical harmonics up to the second degree.
    pub fn bands(&self) -> [DVec3; 9] {
        self.bands
    }

    /// What the shaders read.
    pub fn arrays(self: &Arc<Self>) -> Vec<SceneArray> {
        vec![
            SceneArray::new("sky_texels", self, Self::texel_bytes),
            SceneArray::new("sky_cells", self, Self::cell_bytes),
        ]
    }

    /// The texels as bytes.
    pub fn texel_bytes(&self) -> Vec<u8> {
        bytemuck::cast_slice(&self.texels).to_vec()
    }

    fn cell_bytes(&self) -> Vec<u8> {
        let words = |c: &Cell| [c.stays.to_bits(), c.alias, c.density.to_bits()];
        let words: Vec<[u32; 3]> = self.cells.iter().map(words).collect();
        bytemuck::cast_slice(&words).to_vec()
    }

    fn texel(&self, x: usize, y: usize) -> DVec3 {
        unpacked(self.texels[y * self.size[0] as usize + x])
    }

    /// Solid angle of a texel in a row.
    fn angle(&self, row: u32) -> f64 {
        let [w, h] = self.size.map(f64::from);
        let edge = |y: u32| (PI * f64::from(y) / h).cos();
        2.0 * PI / w * (edge(row) - edge(row + 1))
    }

    /// The direction of the middle of a texel, and its solid angle.
    fn directions(&self) -> impl Iterator<Item = (DVec3, f64, DVec3)> {
        let [w, h] = self.size;
        (0..h).flat_map(move |y| {
            let (angle, down) = (self.angle(y), PI * (f64::from(y) + 0.5) / f64::from(h));
            (0..w).map(move |x| {
                let (sin, cos) = (2.0 * PI * ((f64::from(x) + 0.5) / f64::from(w) - 0.5)).sin_cos();
                let way = DVec3::new(down.sin() * sin, down.sin() * cos, down.cos());
                (way, angle, self.texel(x as usize, y as usize))
            })
        })
    }

    /// The light of each cell: the larger one of what its texels send, and of what it sends where it is
    /// asked, as either alone may miss a small sun.
    fn brightness(&self) -> Vec<f64> {
        let [w, h] = SKY_CELLS;
        let mut sent = vec![0.0; (w * h) as usize];
        let share = f64::from(w * h) / (4.0 * PI);
        for (way, angle, light) in self.directions() {
            let [x, y] = cell_of(way);
            sent[(y * w + x) as usize] += light.element_sum() * angle * share;
        }
        let points = SKY_POINTS * SKY_POINTS;
        for (i, sent) in (0..).zip(&mut sent) {
            let asked = (0..points).map(|k| {
                let at = [
                    i % w * SKY_POINTS + k % SKY_POINTS,
                    i / w * SKY_POINTS + k / SKY_POINTS,
                ];
                let of = |a: usize| (f64::from(at[a]) + 0.5) / f64::from(SKY_POINTS * SKY_CELLS[a]);
                self.radiance(in_cells(of(0), of(1))).element_sum()
            });
            let mean = asked.sum::<f64>() / f64::from(points);
            *sent = mean.max(*sent);
        }
        sent
    }

    fn spread(&self) -> [DVec3; 9] {
        let mut bands = [DVec3::ZERO; 9];
        for (way, angle, light) in self.directions() {
            for (band, y) in bands.iter_mut().zip(harmonics(way)) {
                *band += light * (y * angle / (4.0 * PI));
            }
        }
        for (band, share) in bands.iter_mut().zip(HARMONIC_SHARES) {
            *band *= share;
        }
        bands
    }
}

/// The angle of a direction about the up axis, from 0 to 1. Forward is 0.5.
fn turns(own: DVec3) -> f64 {
    own.x.atan2(own.y) / (2.0 * PI) + 0.5
}

/// The direction of a place in the cells, each number from 0 to 1.
fn in_cells(x: f64, y: f64) -> DVec3 {
    let z = 1.0 - 2.0 * y;
    let (sin, cos) = (2.0 * PI * (x - 0.5)).sin_cos();
    let out = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(out * sin, out * cos, z)
}

fn cell_of(own: DVec3) -> [u32; 2] {
    let at = [turns(own), 0.5 - 0.5 * own.z];
    [0, 1].map(|a| ((at[a] * f64::from(SKY_CELLS[a])) as u32).min(SKY_CELLS[a] - 1))
}

/// The alias table that samples cells as often as they are bright.
fn alias_table(light: &[f64]) -> Vec<Cell> {
    let (count, sum) = (light.len() as f64, light.iter().sum::<f64>());
    let share = |x: &f64| match sum > 0.0 {
        true => (1.0 - SKY_UNIFORM) * x / sum * count + SKY_UNIFORM,
        false => 1.0,
    };
    let shares: Vec<f64> = light.iter().map(share).collect();
    let mut cells: Vec<Cell> = (0..)
        .zip(&shares)
        .map(|(alias, share)| Cell {
            stays: 1.0,
            alias,
            density: (share / (4.0 * PI)) as f32,
        })
        .collect();
    let mut rest = shares;
    let (mut poor, mut rich): (Vec<usize>, Vec<usize>) =
        (0..rest.len()).partition(|i| rest[*i] < 1.0);
    while let (Some(low), Some(&high)) = (poor.pop(), rich.last()) {
        (cells[low].stays, cells[low].alias) = (rest[low] as f32, high as u32);
        rest[high] -= 1.0 - rest[low];
        if rest[high] < 1.0 {
            rich.pop();
            poor.push(high);
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dim gradient with a small, very bright sun.
    fn sunny() -> Sky {
        let [w, h] = [64, 32];
        let light = |i: u32| match [i % w, i / w] {
            [40, 9] => [9e4, 8e4, 3e4],
            [_, y] => [0.2, 0.3, 0.02 * y as f32],
        };
        let all: Vec<[f32; 3]> = (0..w * h).map(light).collect();
        Sky::new([w, h], &all).expect("light")
    }

    /// Evenly spread pairs.
    fn pair(i: u32, seed: u32) -> DVec2 {
        crate::base::random::random_pair(crate::base::random::random_seed([seed, 7]), i, 3)
    }

    #[test]
    fn samples_find_the_light_of_the_whole_sky() {
        let sky = sunny();
        let exact: DVec3 = sky
            .directions()
            .map(|(_, angle, light)| light * angle)
            .sum();
        let count = 1 << 16;
        let mut sum = DVec3::ZERO;
        for i in 0..count {
            let (way, density) = sky.toward(pair(i, 1), pair(i, 2));
            assert!((way.length() - 1.0).abs() < 1e-12);
            assert_eq!(sky.density(way), density, "{way}");
            sum += sky.radiance(way) / density / f64::from(count);
        }
        // Bilinear texels differ a little from constant ones.
        assert!(
            (sum / exact - 1.0).abs().max_element() < 0.01,
            "{sum} {exact}"
        );
    }

    #[test]
    fn the_densities_are_those_of_a_distribution() {
        let mean = |f: &dyn Fn(&Cell) -> f64, sky: &Sky| {
            sky.cells.iter().map(f).sum::<f64>() / sky.cells.len() as f64
        };
        let all = mean(&|c| 4.0 * PI * f64::from(c.density), &sunny());
        assert!((all - 1.0).abs() < 1e-6, "{all}");
    }

    #[test]
    fn the_ambient_light_is_that_of_the_half_space() {
        let sky = sunny();
        for normal in [
            DVec3::Z,
            DVec3::new(0.6, 0.0, 0.8),
            DVec3::new(0.0, -0.8, -0.6),
        ] {
            let parts = sky.directions();
            let exact: DVec3 = parts
                .map(|(way, angle, light)| light * (way.dot(normal).max(0.0) * angle / PI))
                .sum();
            let found = sky.ambient(normal);
            // The harmonics leave out up to a tenth of the brightest light there is.
            let scale = 0.1 * sky.ambient(DVec3::Z).max_element();
            assert!(
                (found - exact).abs().max_element() < scale,
                "{normal}: {found} {exact}"
            );
        }
        let even = Sky::new([8, 4], &[[0.5; 3]; 32]).expect("light");
        let found = even.ambient(DVec3::new(0.48, 0.6, 0.64));
        assert!((found - 0.5).abs().max_element() < 0.02, "{found}");
    }

    #[test]
    fn texels_keep_their_light() {
        for c in [
            [0.0; 3],
            [1.0, 0.5, 1e-3],
            [3e9, 1.0, 0.0],
            [1e-9, 2e-9, 3e-9],
            [65535.0; 3],
        ] {
            let off = unpacked(packed(c)) - DVec3::from_array(c.map(f64::from));
            let most = c.into_iter().fold(0.0, f32::max);
            assert!(
                off.abs().max_element() <= f64::from(most) / 65536.0,
                "{c:?} {off}"
            );
        }
    }
}
