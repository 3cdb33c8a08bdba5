//! The 3 x 3 minimum of a cone map (Bán, Valasek, Bálint, Vad: Robust Cone Step Mapping,
//! EGSR 2024), on the CPU and on a device with the same result.
//! Twin: `wgsl/heightfield/generate/nine.wgsl`.

use std::time::Instant;

use bytemuck::bytes_of;
use rayon::prelude::*;

use super::device::Maker;
use super::generator::GenerateError;
use super::uniform::NineUniform;
use crate::gpu::buffer::uniform;
use crate::heightfield::conemap::ConeMap;
use crate::shader::Program;
use crate::wgsl;

/// A place or the one next to it along an axis: beyond the ends the last one, or the one
/// that comes round.
fn beside(map: &ConeMap, axis: usize, i: i64) -> usize {
    let n = i64::from(map.size[axis]);
    let i = if map.wrap[axis] {
        i.rem_euclid(n)
    } else {
        i.clamp(0, n - 1)
    };
    i as usize
}

/// A map whose cones are as narrow as the narrowest among each place and its eight
/// neighbours, channel by channel.
pub fn least_of_nine(map: &ConeMap) -> ConeMap {
    let [width, height] = map.size.map(|n| n as usize);
    let channels = map.ratios.len() / (width * height);
    let least = |i: usize| {
        let (place, channel) = (i / channels, i % channels);
        let (x, y) = ((place % width) as i64, (place / width) as i64);
        let nine = (0..9).map(|k| {
            let (x, y) = (beside(map, 0, x + k % 3 - 1), beside(map, 1, y + k / 3 - 1));
            map.ratios[(y * width + x) * channels + channel]
        });
        nine.fold(f64::INFINITY, f64::min)
    };
    ConeMap {
        ratios: (0..map.ratios.len()).into_par_iter().map(least).collect(),
        ..*map
    }
}

/// Makes a band of the 3 x 3 minimum.
pub fn nine_program() -> Program {
    Program::new("nine", vec![wgsl!("heightfield/generate/nine.wgsl")])
}

/// The bits of a ratio, high word first. Ratios are not negative, so that their bits come
/// in their own order: a device without f64 finds the least of them to the last bit.
fn words(ratio: &f64) -> [u32; 2] {
    let bits = ratio.to_bits();
    [(bits >> 32) as u32, bits as u32]
}

/// The ratio of its words.
fn ratio([high, low]: [u32; 2]) -> f64 {
    f64::from_bits(u64::from(high) << 32 | u64::from(low))
}

impl Maker<'_> {
    /// As [`least_of_nine`], on the device, some rows at a time.
    ///
    /// # Errors
    /// A map whose rows are too long for the device, and its failures.
    pub fn least_of_nine(&mut self, map: &ConeMap) -> Result<ConeMap, GenerateError> {
        let start = Instant::now();
        let [width, height] = map.size;
        let row = map.ratios.len() / height as usize;
        let most = (self.cutting.band / width).clamp(1, height);
        let kernel = self.kernel(&nine_program())?;
        let wide = self.storage("wide", map.size, row * (most as usize + 2))?;
        let narrow = self.storage("narrow", map.size, row * most as usize)?;
        let mut ratios = Vec::with_capacity(map.ratios.len());
        for first in (0..height).step_by(most as usize) {
            let rows = most.min(height - first);
            // A row more on either side, which the kernel needs not know how to find.
            let around = (-1..=i64::from(rows)).flat_map(|y| {
                let y = beside(map, 1, i64::from(first) + y);
                &map.ratios[y * row..][..row]
            });
            wide.write(self.device, &around.map(words).collect::<Vec<_>>());
            let told = NineUniform {
                width,
                rows,
                wrap: u32::from(map.wrap[0]),
                channels: row as u32 / width,
            };
            let told = uniform(self.device, "nine", bytes_of(&told));
            let bound = [
                ("nine_parameters", &told),
                ("wide", &wide.raw),
                ("narrow", &narrow.raw),
            ];
            let groups = [(row as u32).div_ceil(8), rows.div_ceil(8)];
            self.run(&kernel, &bound, groups)?;
            let read = narrow.read(self.device, row * rows as usize)?;
            ratios.extend(read.into_iter().map(ratio));
        }
        self.device_ms += start.elapsed().as_secs_f64() * 1e3;
        Ok(ConeMap { ratios, ..*map })
    }
}
