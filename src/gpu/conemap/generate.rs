//! Cone maps from a device: the same as from the CPU, bit for bit.
//!
//! The device finds, in f32, which place bounds each cone. Ratios are computed from that
//! in f64. The few places for which another one costs nearly as much, closer than f32
//! can tell, are searched again on the CPU. So the map does not depend on how a device
//! rounds, as long as it is as accurate as WGSL demands. Only `RelaxedSearch`, which
//! compares heights along rays, may end at another step now and then.
//!
//! The work is divided into bands of rows, and each dispatch does a bounded number of rounds
//! per place. The division never changes a map.

use bytemuck::{Pod, bytes_of};

use crate::base::parallel::collect;
use crate::gpu::buffer::{Buffer, uniform};
use crate::gpu::device::Device;
use crate::gpu::error::{RenderError, check_room};
use crate::gpu::kernel::{Kernel, Kernels};
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::generator::{
    GenerateError, Generator, Options, ShareWatch,
};
use crate::heightfield::conemap::generate::pyramid::{self, Tiles};
use crate::heightfield::conemap::generate::refine_f64::{is_ambiguous, refined};
use crate::heightfield::conemap::generate::task::MapTask;
use crate::heightfield::conemap::generate::uniform::{GenerateUniform, SearchState};
use crate::heightfield::heights::{Heights, Patches};
use crate::heightfield::max_mip::MaxMip;

/// How the work is divided. It never changes a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Division {
    /// Places of a band, about: whole rows of workgroups are taken.
    pub band: u32,
    /// Rounds that a place may take in one dispatch: nodes visited, or samples looked at.
    pub rounds: u32,
}

impl Default for Division {
    fn default() -> Self {
        Self {
            // 2 MiB to read back, and enough to keep a large device busy.
            band: 1 << 16,
            // With the band 30 million rounds: half a second on two cores, and few
            // searches need as many.
            rounds: 512,
        }
    }
}

/// Makes maps on one device, and keeps what it compiles.
pub struct Maker<'a> {
    pub(crate) device: &'a Device,
    /// How work is divided.
    pub division: Division,
    /// Places of the last map that were searched again on the CPU.
    pub refined: usize,
    /// Milliseconds that the dispatches of the last map took, each with the reading of
    /// what it found.
    pub device_ms: f64,
    pub(crate) kernels: Kernels,
}

impl<'a> Maker<'a> {
    /// A maker on an open device.
    pub fn new(device: &'a Device) -> Self {
        Self {
            device,
            division: Division::default(),
            refined: 0,
            device_ms: 0.0,
            kernels: Kernels::default(),
        }
    }

    /// A buffer of values, if the device can bind it.
    pub(crate) fn storage<T: Pod>(&self, name: &str, len: usize) -> Result<Buffer<T>, RenderError> {
        let needed = (len * size_of::<T>()) as u64;
        let device = self.device;
        check_room(&device.info.name, name, needed, device.most_bound())?;
        Ok(Buffer::new(device, name, len))
    }

    fn upload<T: Pod>(&self, name: &str, values: &[T]) -> Result<Buffer<T>, RenderError> {
        let buffer = self.storage(name, values.len())?;
        buffer.write(self.device, values);
        Ok(buffer)
    }

    /// Builds the tiles over a grid.
    fn tiles(&mut self, layout: &Tiles, values: &[f32]) -> Result<Buffer<[f32; 4]>, RenderError> {
        let kernel = self.kernels.get(self.device, &pyramid::program())?;
        let grid = self.upload("grid", values)?;
        let tiles = self.storage("tiles", layout.count as usize)?;
        for level in 1..layout.levels.len() {
            let parameters = uniform(self.device, "level", bytes_of(&layout.uniform(level)));
            let bound = [
                ("pyramid_parameters", &parameters),
                ("grid", &grid.raw),
                ("tiles", &tiles.raw),
            ];
            let groups = layout.levels[level].map(|n| n.div_ceil(8));
            kernel.run(self.device, &bound, groups)?;
        }
        // The grid's memory is free once the tiles are made.
        self.device.wait()?;
        Ok(tiles)
    }

    /// The pyramid of maxima over a grid of values of at least 0, built on the device.
    ///
    /// # Errors
    /// A grid too large for the device, and its failures.
    pub fn max_mip(&mut self, size: [u32; 2], values: &[f32]) -> Result<MaxMip, RenderError> {
        let layout = Tiles::new(size);
        let tiles = self.tiles(&layout, values)?;
        let read = tiles.read(self.device, layout.count as usize);
        Ok(layout.unpack(&read.map_err(RenderError::from)?))
    }

    /// Makes a cone map; see [`crate::heightfield::conemap::generate::cpu::generate`].
    ///
    /// # Errors
    /// Options out of range; a map too large for the device, and its failures;
    /// [`GenerateError::Cancelled`] when `watch` returns `false`.
    pub fn generate(
        &mut self,
        generator: Generator,
        heights: &Heights,
        patches: Patches,
        options: &Options,
        watch: ShareWatch<'_>,
    ) -> Result<ConeMap, GenerateError> {
        let task = MapTask::new(generator, heights, patches, options)?;
        (self.refined, self.device_ms) = (0, 0.0);
        let map = task.map(self.ratios(&task, watch)?);
        if options.min3x3 {
            return Ok(self.min3x3(&map)?);
        }
        Ok(map)
    }

    fn ratios(
        &mut self,
        task: &MapTask<'_>,
        watch: ShareWatch<'_>,
    ) -> Result<Vec<f64>, RenderError> {
        let kernel = self.kernels.get(self.device, &task.program())?;
        let size = task.size;
        let layout = Tiles::new(size);
        let values = self.upload("heights", &task.values)?;
        let mut pyramids = Vec::new();
        for mip in &task.mips {
            pyramids.push(self.tiles(&layout, &mip.levels[0].max)?);
        }
        if pyramids.is_empty() {
            // Programs without a pyramid bind nothing of it.
            pyramids.push(Buffer::new(self.device, "no tiles", 1));
        }
        // Workgroups are 8 rows high.
        let rows = (self.division.band / size[0] / 8).max(1) * 8;
        let bands = Bands {
            task,
            kernel: &kernel,
            layout: &layout,
            values: &values.raw,
            pyramids: &pyramids,
            searches: self.storage("searches", (rows * size[0]) as usize)?,
        };
        let mut ratios = Vec::with_capacity(task.values.len() * task.generator.channels());
        for first in (0..size[1]).step_by(rows as usize) {
            let rows = rows.min(size[1] - first);
            let mut done =
                |part: f64| watch((f64::from(first) + part * f64::from(rows)) / f64::from(size[1]));
            self.band(&bands, first, rows, &mut ratios, &mut done)?;
            if !done(1.0) {
                return Err(RenderError::Cancelled);
            }
        }
        Ok(ratios)
    }

    /// Searches from all places of some rows.
    fn band(
        &mut self,
        bands: &Bands<'_>,
        first: u32,
        rows: u32,
        ratios: &mut Vec<f64>,
        watch: ShareWatch<'_>,
    ) -> Result<(), RenderError> {
        let task = bands.task;
        let (searches, per_cone) = (task.method.sectors().len(), task.searches_per_cone());
        // What was found for each cone of a place, over all places of the band.
        let mut found: Vec<Vec<SearchState>> = Vec::new();
        for search in 0..searches {
            let watch = &mut |part| watch((search as f64 + part) / searches as f64);
            let mut parameters = bands.parameters(first, rows, search);
            parameters.rounds = (self.division.rounds / task.method.rounds()).max(1);
            parameters.keeps = u32::from(search % per_cone > 0);
            let start = (self.device.clock)();
            let read = self.until_done(bands, search, parameters, watch)?;
            self.device_ms += (self.device.clock)() - start;
            if (search + 1) % per_cone == 0 {
                found.push(read);
            }
        }
        let start = (first * task.size[0]) as usize;
        let refine = |i: usize| {
            let place: Vec<SearchState> = found.iter().map(|cone| cone[i]).collect();
            let again = is_ambiguous(task, &place);
            (refined(task, start + i, &place), again)
        };
        let all: Vec<_> = collect(0..found[0].len(), 1, refine);
        for (cones, again) in &all {
            ratios.extend_from_slice(&cones[..found.len()]);
            self.refined += usize::from(*again);
        }
        Ok(())
    }

    /// Dispatches until every place of a band is done.
    fn until_done(
        &self,
        bands: &Bands<'_>,
        search: usize,
        mut parameters: GenerateUniform,
        watch: ShareWatch<'_>,
    ) -> Result<Vec<SearchState>, RenderError> {
        let device = self.device;
        let buffer = uniform(device, "generate", bytes_of(&parameters));
        let bound = [
            ("generate_parameters", &buffer),
            ("heights", bands.values),
            ("tiles", &bands.pyramids[bands.task.pyramid(search)].raw),
            ("searches", &bands.searches.raw),
        ];
        let places = (parameters.rows * parameters.size[0]) as usize;
        let groups = [parameters.size[0], parameters.rows].map(|n| n.div_ceil(8));
        parameters.begins = 1;
        loop {
            device.queue.write_buffer(&buffer, 0, bytes_of(&parameters));
            bands.kernel.run(device, &bound, groups)?;
            let read = bands.searches.read(device, places)?;
            let is_moving = |s: &&SearchState| s.stage != SearchState::DONE;
            let moving = read.iter().filter(is_moving).count();
            if moving == 0 {
                return Ok(read);
            }
            if read.iter().any(|s| s.stage == 0) {
                // Even the shortest dispatch moves a search out of its first stage.
                return Err(RenderError::Stuck(device.info.name.clone()));
            }
            parameters.begins = 0;
            let share = 1.0 - moving as f64 / places as f64;
            if !watch(0.99 * share) {
                return Err(RenderError::Cancelled);
            }
        }
    }
}

/// What all bands of a map share.
struct Bands<'a> {
    task: &'a MapTask<'a>,
    kernel: &'a Kernel,
    layout: &'a Tiles,
    values: &'a wgpu::Buffer,
    pyramids: &'a [Buffer<[f32; 4]>],
    searches: Buffer<SearchState>,
}

impl Bands<'_> {
    /// The parameters of the kernel for some rows.
    fn parameters(&self, first: u32, rows: u32, search: usize) -> GenerateUniform {
        let task = self.task;
        let mut at = [[0; 4]; 4];
        for (i, start) in self.layout.at.iter().enumerate() {
            at[i / 4][i % 4] = *start;
        }
        GenerateUniform {
            size: task.size,
            wrap: task.heights.wrap().map(u32::from),
            first,
            rows,
            levels: (self.layout.levels.len() - 1) as u32,
            sector: task.method.sectors()[search].codes()[1],
            steps: task.options.search_steps,
            offset: task.options.offset as f32,
            top: task.top(search),
            at,
            ..GenerateUniform::default()
        }
    }
}
