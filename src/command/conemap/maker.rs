//! Makes cone maps on the device of an executor, or on the CPU.

use crate::command::executor::Executor;
use crate::gpu::RenderError;
use crate::gpu::conemap::generate::Maker;
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::cpu;
use crate::heightfield::conemap::generate::generator::{
    GenerateError, Generator, Options, ShareWatch,
};
use crate::heightfield::heights::{Heights, Patches};
use crate::heightfield::max_mip::MaxMip;

/// What makes cone maps.
pub struct MapMaker<'a>(Option<Maker<'a>>);

impl<'a> MapMaker<'a> {
    /// The maker of an executor.
    pub fn new(executor: &'a Executor) -> Self {
        Self(executor.device().map(Maker::new))
    }

    /// Makes a map.
    ///
    /// # Errors
    /// The device failed, or `watch` returned `false`.
    pub fn generate(
        &mut self,
        generator: Generator,
        heights: &Heights,
        patches: Patches,
        options: &Options,
        watch: ShareWatch<'_>,
    ) -> Result<ConeMap, GenerateError> {
        match &mut self.0 {
            Some(maker) => maker.generate(generator, heights, patches, options, watch),
            None => cpu::generate(generator, heights, patches, options, watch),
        }
    }

    /// Makes the pyramid of maxima over apexes.
    ///
    /// # Errors
    /// The device failed.
    pub fn max_mip(&mut self, cells: [u32; 2], apexes: Vec<f32>) -> Result<MaxMip, RenderError> {
        match &mut self.0 {
            Some(maker) => maker.max_mip(cells, &apexes),
            None => Ok(MaxMip::new(cells, apexes)),
        }
    }
}
