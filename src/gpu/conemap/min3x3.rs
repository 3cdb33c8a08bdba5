//! The 3 x 3 minimum of a cone map on a device.

use bytemuck::bytes_of;

use crate::gpu::buffer::uniform;
use crate::gpu::conemap::generate::Maker;
use crate::gpu::error::RenderError;
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::min3x3::{beside, program};
use crate::heightfield::conemap::generate::uniform::Min3x3Uniform;

/// The bits of a ratio, high word first. Ratios are not negative, so their bits are in the
/// order of the ratios: a device without f64 finds the least of them to the last bit.
fn words(ratio: &f64) -> [u32; 2] {
    let bits = ratio.to_bits();
    [(bits >> 32) as u32, bits as u32]
}

impl Maker<'_> {
    /// As [`crate::heightfield::conemap::generate::min3x3::min3x3`], on the device, some rows
    /// at a time.
    ///
    /// # Errors
    /// A map whose rows are too long for the device, and its failures.
    pub fn min3x3(&mut self, map: &ConeMap) -> Result<ConeMap, RenderError> {
        let start = (self.device.clock)();
        let [width, height] = map.size;
        let row = map.ratios.len() / height as usize;
        let most = (self.division.band / width).clamp(1, height);
        let kernel = self.kernels.get(self.device, &program())?;
        let wide = self.storage("wide", row * (most as usize + 2))?;
        let narrow = self.storage("narrow", row * most as usize)?;
        let mut ratios = Vec::with_capacity(map.ratios.len());
        for first in (0..height).step_by(most as usize) {
            let rows = most.min(height - first);
            // A row more on either side, so that the kernel need not know how to find it.
            let around = (-1..=i64::from(rows)).flat_map(|y| {
                let y = beside(map, 1, i64::from(first) + y);
                &map.ratios[y * row..][..row]
            });
            wide.write(self.device, &around.map(words).collect::<Vec<_>>());
            let parameters = Min3x3Uniform {
                width,
                rows,
                wrap: u32::from(map.wrap[0]),
                channels: row as u32 / width,
            };
            let parameters = uniform(self.device, "min3x3", bytes_of(&parameters));
            let bound = [
                ("min3x3_parameters", &parameters),
                ("wide", &wide.raw),
                ("narrow", &narrow.raw),
            ];
            let groups = [(row as u32).div_ceil(8), rows.div_ceil(8)];
            kernel.run(self.device, &bound, groups)?;
            let read = narrow.read(self.device, row * rows as usize)?;
            let ratio = |[high, low]: [u32; 2]| u64::from(high) << 32 | u64::from(low);
            ratios.extend(read.into_iter().map(|words| f64::from_bits(ratio(words))));
        }
        self.device_ms += (self.device.clock)() - start;
        Ok(ConeMap { ratios, ..*map })
    }
}
