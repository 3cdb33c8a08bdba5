//! Slopes at the samples, on a device.

use bytemuck::bytes_of;

use crate::gpu::buffer::uniform;
use crate::gpu::conemap::generate::Maker;
use crate::heightfield::conemap::generate::generator::GenerateError;
use crate::heightfield::conemap::generate::slopes::slopes_program;
use crate::heightfield::conemap::generate::uniform::SlopesUniform;
use crate::heightfield::heights::Heights;

impl Maker<'_> {
    /// As [`crate::heightfield::conemap::generate::slopes::slopes`], on the device, some rows at a time. A device may take
    /// for 0 what is less than 2^-126.
    ///
    /// # Errors
    /// Heights whose rows are too long for the device, and its failures.
    pub fn slopes(&mut self, heights: &Heights) -> Result<Vec<[f32; 2]>, GenerateError> {
        let size = heights.size();
        let [width, height] = size;
        let row = width as usize;
        let most = (self.cutting.band / width).clamp(1, height);
        let kernel = self.kernel(&slopes_program())?;
        let near = self.storage("near", size, row * (most as usize + 2))?;
        let found = self.storage::<[f32; 2]>("found", size, row * most as usize)?;
        let mut slopes = Vec::with_capacity(heights.data().len());
        for first in (0..height).step_by(most as usize) {
            let rows = most.min(height - first);
            // A row more on either side, which the kernel needs not know how to find.
            let around = (-1..=i64::from(rows)).flat_map(|y| {
                let y = heights.index(1, i64::from(first) + y) as usize;
                &heights.data()[y * row..][..row]
            });
            near.write(self.device, &around.copied().collect::<Vec<f32>>());
            let told = SlopesUniform {
                size,
                wrap: heights.wrap().map(u32::from),
                first,
                rows,
                pad0: 0,
                pad1: 0,
            };
            let told = uniform(self.device, "slopes", bytes_of(&told));
            let bound = [
                ("slopes_parameters", &told),
                ("near", &near.raw),
                ("found", &found.raw),
            ];
            self.run(&kernel, &bound, [width.div_ceil(8), rows.div_ceil(8)])?;
            slopes.extend(found.read(self.device, row * rows as usize)?);
        }
        Ok(slopes)
    }
}
