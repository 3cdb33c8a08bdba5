//! Cone maps on a device: the same as from the CPU, bit for bit.
//!
//! The device finds, in f32, which place bounds each cone. Ratios are computed from that
//! in f64; the few places for which another one costs nearly as much, closer than f32
//! can tell, are searched again on the CPU. So the map does not depend on how a device
//! rounds, as long as it is as accurate as WGSL demands. Only `RelaxedSearch`, which
//! decides by comparing heights along rays, may come out at another step now and then.
//!
//! The work is cut: bands of rows, and in each dispatch a bounded number of rounds per
//! place. How it is cut never changes a map.

use std::rc::Rc;
use std::time::Instant;

use bytemuck::{Pod, bytes_of};
use rayon::prelude::*;

use crate::base::shader::Program;
use crate::gpu::buffer::{Buffer, uniform};
use crate::gpu::device::Device;
use crate::gpu::kernel::{Kernel, KernelError};
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::generator::{GenerateError, Generator, Options, Watch};
use crate::heightfield::conemap::generate::grid_distance::Aim;
use crate::heightfield::conemap::generate::mips::{ConeLevel, rounded_down};
use crate::heightfield::conemap::generate::program::program;
use crate::heightfield::conemap::generate::pyramid::{
    Tiles, mip_levels, mips_program, tiles_program,
};
use crate::heightfield::conemap::generate::refine_f64::{settled, unsettled};
use crate::heightfield::conemap::generate::task::MapTask;
use crate::heightfield::conemap::generate::uniform::{GenerateUniform, Search};
use crate::heightfield::heights::{Heights, Patches};
use crate::heightfield::max_mip::MaxMip;

/// How the work is cut. It never changes a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cutting {
    /// Places of a band, about: whole rows of workgroups are taken.
    pub band: u32,
    /// Rounds that a place may take in one dispatch: nodes visited, or samples looked at.
    pub rounds: u32,
}

impl Default for Cutting {
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

/// Makes maps on one device; keeps what it compiles.
pub struct Maker<'a> {
    pub(crate) device: &'a Device,
    /// How work is cut.
    pub cutting: Cutting,
    /// Places of the last map that were settled on the CPU.
    pub settled: usize,
    /// Milliseconds that the dispatches of the last map took, each with the reading of
    /// what it found.
    pub device_ms: f64,
    kernels: Vec<(Program, Rc<Kernel>)>,
}

/// Buffers by the names of the WGSL variables.
type Bound<'a> = [(&'static str, &'a wgpu::Buffer)];

impl<'a> Maker<'a> {
    /// A maker on an open device.
    pub fn new(device: &'a Device) -> Self {
        Self {
            device,
            cutting: Cutting::default(),
            settled: 0,
            device_ms: 0.0,
            kernels: Vec::new(),
        }
    }

    pub(crate) fn kernel(&mut self, program: &Program) -> Result<Rc<Kernel>, KernelError> {
        if let Some((_, kernel)) = self.kernels.iter().find(|(p, _)| p == program) {
            return Ok(kernel.clone());
        }
        let kernel = Rc::new(Kernel::new(self.device, program)?);
        self.kernels.push((program.clone(), kernel.clone()));
        Ok(kernel)
    }

    /// Runs a kernel over so many workgroups. What a device complains of is told when
    /// its results are read.
    pub(crate) fn run(
        &self,
        kernel: &Kernel,
        bound: &Bound<'_>,
        groups: [u32; 2],
    ) -> Result<(), KernelError> {
        let named = |name: &str| bound.iter().find(|b| b.0 == name).map(|b| b.1);
        let bind = kernel.bind(self.device, named)?;
        let mut encoder = self
            .device
            .device
            .create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        kernel.dispatch(&mut pass, &bind, groups);
        drop(pass);
        self.device.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// A buffer of values, if the device can bind it.
    pub(crate) fn storage<T: Pod>(
        &self,
        name: &str,
        size: [u32; 2],
        len: usize,
    ) -> Result<Buffer<T>, GenerateError> {
        let needed = (len * size_of::<T>()) as u64;
        let most = self.device.most_bound();
        if needed > most {
            let device = self.device.info.name.clone();
            return Err(GenerateError::TooLarge {
                device,
                size,
                needed,
                most,
            });
        }
        Ok(Buffer::new(self.device, name, len))
    }

    /// Builds the tiles over a grid.
    fn tiles(
        &mut self,
        layout: &Tiles,
        grid: &wgpu::Buffer,
    ) -> Result<Buffer<[f32; 4]>, GenerateError> {
        let kernel = self.kernel(&tiles_program())?;
        let tiles = self.storage("tiles", layout.size, layout.count as usize)?;
        for level in 1..layout.levels.len() {
            let told = uniform(self.device, "level", bytes_of(&layout.uniform(level)));
            let bound = [
                ("pyramid_parameters", &told),
                ("grid", grid),
                ("tiles", &tiles.raw),
            ];
            let groups = layout.levels[level].map(|n| n.div_ceil(8));
            self.run(&kernel, &bound, groups)?;
        }
        Ok(tiles)
    }

    /// The pyramid of maxima over a grid of values of at least 0, built on the device.
    ///
    /// # Errors
    /// A grid too large for the device, and its failures.
    pub fn max_mip(&mut self, size: [u32; 2], values: &[f32]) -> Result<MaxMip, GenerateError> {
        let layout = Tiles::new(size);
        let grid = self.upload("grid", size, values)?;
        let tiles = self.tiles(&layout, &grid.raw)?;
        let read = tiles.read(self.device, layout.count as usize)?;
        Ok(layout.unpack(&read))
    }

    fn upload<T: Pod>(
        &self,
        name: &str,
        size: [u32; 2],
        values: &[T],
    ) -> Result<Buffer<T>, GenerateError> {
        let buffer = self.storage(name, size, values.len())?;
        buffer.write(self.device, values);
        Ok(buffer)
    }

    /// Makes a cone map; see [`crate::heightfield::conemap::generate::cpu::generate`].
    ///
    /// # Errors
    /// Options that are out of range; a map too large for the device, and its failures;
    /// [`GenerateError::Cancelled`] when `watch` returns `false`.
    pub fn generate(
        &mut self,
        generator: Generator,
        heights: &Heights,
        patches: Patches,
        options: &Options,
        watch: Watch<'_>,
    ) -> Result<ConeMap, GenerateError> {
        let prepared = MapTask::new(generator, heights, patches, options)?;
        (self.settled, self.device_ms) = (0, 0.0);
        let kernel = self.kernel(&program(&prepared))?;
        let size = prepared.size;
        let layout = Tiles::new(size);
        let values = self.upload("heights", size, &prepared.values)?;
        let mut pyramids = Vec::new();
        for mip in &prepared.mips {
            let grid = self.upload("limits", size, &mip.levels[0].max)?;
            pyramids.push(self.tiles(&layout, &grid.raw)?);
            // The grid is in the tiles now, and its memory is free once they are made.
            self.device.wait()?;
        }
        let channels = generator.channels();
        let mut ratios = Vec::with_capacity(prepared.values.len() * channels);
        // Workgroups are 8 rows high.
        let rows = (self.cutting.band / size[0] / 8).max(1) * 8;
        let band = Band {
            prepared: &prepared,
            kernel: &kernel,
            layout: &layout,
            values: &values.raw,
            pyramids: &pyramids,
            searches: self.storage("searches", size, (rows * size[0]) as usize)?,
        };
        for first in (0..size[1]).step_by(rows as usize) {
            let rows = rows.min(size[1] - first);
            let done = |part: f64| (f64::from(first) + part * f64::from(rows)) / f64::from(size[1]);
            let mut told = |part: f64| watch(done(part));
            self.band(&band, first, rows, &mut ratios, &mut told)?;
            if !watch(done(1.0)) {
                return Err(GenerateError::Cancelled);
            }
        }
        let map = prepared.map(ratios);
        if options.min3x3 {
            return self.min3x3(&map);
        }
        Ok(map)
    }

    /// Searches from all places of some rows.
    fn band(
        &mut self,
        band: &Band<'_>,
        first: u32,
        rows: u32,
        ratios: &mut Vec<f64>,
        watch: Watch<'_>,
    ) -> Result<(), GenerateError> {
        let prepared = band.prepared;
        let aims = prepared.aims();
        let apart = prepared.generator == Generator::Quad;
        let mut found: Vec<Vec<Search>> = Vec::new();
        for turn in 0..aims.len().max(1) {
            let (mip, aim) = aims.get(turn).copied().unwrap_or((0, Aim::Around));
            let mut told = band.told(first, rows, mip, aim);
            told.rounds = (self.cutting.rounds / weight(prepared.generator)).max(1);
            told.keeps = u32::from(turn > 0 && !apart);
            let start = Instant::now();
            let read = self.until_done(band, mip, told, watch)?;
            self.device_ms += start.elapsed().as_secs_f64() * 1e3;
            if apart || turn + 1 == aims.len().max(1) {
                found.push(read);
            }
        }
        let start = (first * prepared.size[0]) as usize;
        let settle = |i: usize| {
            let all: [Search; 4] = std::array::from_fn(|c| found[c.min(found.len() - 1)][i]);
            settled(prepared, start + i, &all)
        };
        let channels = found.len();
        let open = |i: &usize| unsettled(prepared, found.iter().map(|f| &f[*i]));
        self.settled += (0..found[0].len()).filter(open).count();
        let all: Vec<[f64; 4]> = (0..found[0].len()).into_par_iter().map(settle).collect();
        for four in &all {
            ratios.extend_from_slice(&four[..channels]);
        }
        Ok(())
    }

    /// Dispatches until every place of a band is done.
    fn until_done(
        &self,
        band: &Band<'_>,
        mip: usize,
        mut told: GenerateUniform,
        watch: Watch<'_>,
    ) -> Result<Vec<Search>, GenerateError> {
        let parameters = uniform(self.device, "generate", bytes_of(&told));
        let none;
        let tiles = match band.pyramids.get(mip) {
            Some(tiles) => &tiles.raw,
            None => {
                none = Buffer::<[f32; 4]>::new(self.device, "none", 1);
                &none.raw
            }
        };
        let bound = [
            ("generate_parameters", &parameters),
            ("heights", band.values),
            ("tiles", tiles),
            ("searches", &band.searches.raw),
        ];
        let places = (told.rows * told.size[0]) as usize;
        told.begins = 1;
        loop {
            self.device
                .queue
                .write_buffer(&parameters, 0, bytes_of(&told));
            let groups = [told.size[0].div_ceil(8), told.rows.div_ceil(8)];
            self.run(band.kernel, &bound, groups)?;
            let read = band.searches.read(self.device, places)?;
            let moving = read.iter().filter(|s| s.stage != Search::DONE).count();
            if moving == 0 {
                return Ok(read);
            }
            if read.iter().any(|s| s.stage == 0) {
                // Even the shortest turn moves a search out of its first stage.
                return Err(GenerateError::Stuck(self.device.info.name.clone()));
            }
            told.begins = 0;
            let share = 1.0 - moving as f64 / places as f64;
            if !watch(0.99 * share) {
                return Err(GenerateError::Cancelled);
            }
        }
    }

    /// All levels over a cone map of `Samples`, `Relaxed` or a walk, as [`crate::heightfield::conemap::generate::mips`]
    /// makes them, from ratios rounded down to f32; a quad map's channel by channel.
    /// `None` if there are not as many heights as places.
    ///
    /// # Errors
    /// A map too large for the device, and its failures.
    pub fn mips(
        &mut self,
        heights: &[f32],
        map: &ConeMap,
    ) -> Result<Option<Vec<ConeLevel>>, GenerateError> {
        let places = heights.len();
        if places == 0
            || places != map.size[0] as usize * map.size[1] as usize
            || !map.ratios.len().is_multiple_of(places)
        {
            return Ok(None);
        }
        let channels = map.ratios.len() / places;
        let kernel = self.kernel(&mips_program())?;
        let above = mip_levels(map.size);
        let total = above.last().map_or(places, |last| last.at as usize + 1);
        let (mut apexes, mut narrow) = (Vec::new(), Vec::new());
        for channel in 0..channels {
            let own = map.ratios.iter().skip(channel).step_by(channels);
            let own: Vec<f32> = own.map(|r| rounded_down(*r)).collect();
            let high = self.storage("apexes", map.size, total)?;
            high.write(self.device, heights);
            let least = self.storage("ratios", map.size, total)?;
            least.write(self.device, &own);
            for told in &above {
                let level = uniform(self.device, "level", bytes_of(told));
                let bound = [
                    ("mip_parameters", &level),
                    ("apexes", &high.raw),
                    ("ratios", &least.raw),
                ];
                self.run(&kernel, &bound, told.size.map(|n| n.div_ceil(8)))?;
            }
            apexes = high.read(self.device, total)?;
            narrow.push(least.read(self.device, total)?);
        }
        let starts = std::iter::once((map.size, 0)).chain(above.iter().map(|l| (l.size, l.at)));
        let level = |(size, at): ([u32; 2], u32)| {
            let (at, count) = (at as usize, size[0] as usize * size[1] as usize);
            ConeLevel {
                size,
                heights: apexes[at..at + count].to_vec(),
                ratios: (at..at + count)
                    .flat_map(|i| narrow.iter().map(move |n: &Vec<f32>| f64::from(n[i])))
                    .collect(),
            }
        };
        Ok(Some(starts.map(level).collect()))
    }
}

/// How many rounds of a search one round of a generator takes. Of places that a device
/// runs in step one may follow a ray to its end while the others wait, each in its turn.
fn weight(generator: Generator) -> u32 {
    if generator == Generator::RelaxedSearch {
        8
    } else {
        1
    }
}

/// What all bands of a map share.
struct Band<'a> {
    prepared: &'a MapTask<'a>,
    kernel: &'a Kernel,
    layout: &'a Tiles,
    values: &'a wgpu::Buffer,
    pyramids: &'a [Buffer<[f32; 4]>],
    searches: Buffer<Search>,
}

impl Band<'_> {
    /// What the kernel is told of some rows.
    fn told(&self, first: u32, rows: u32, mip: usize, aim: Aim) -> GenerateUniform {
        let prepared = self.prepared;
        let mut at = [[0; 4]; 4];
        for (i, start) in self.layout.at.iter().enumerate() {
            at[i / 4][i % 4] = *start;
        }
        GenerateUniform {
            size: prepared.size,
            wrap: prepared.heights.wrap().map(u32::from),
            first,
            rows,
            levels: (self.layout.levels.len() - 1) as u32,
            aim: match aim {
                Aim::Around => 0,
                Aim::Quadrant(up) => u32::from(!up[0]) + 2 * u32::from(!up[1]),
                Aim::Side { axis, up } => 2 * axis as u32 + u32::from(!up),
            },
            steps: prepared.options.search_steps,
            offset: prepared.options.offset as f32,
            top: match prepared.mips.get(mip) {
                Some(mip) => mip.top(),
                None => prepared.top as f32,
            },
            at,
            ..GenerateUniform::default()
        }
    }
}
