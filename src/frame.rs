//! The result of a render: layers of one value per pixel, and the figures of each pass.

/// What a pixel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// The ray left the bounds.
    Sky = 0,
    /// The ray met the surface.
    Hit = 1,
    /// A limit was reached before either; never counted as a hit.
    Unconverged = 2,
}

impl State {
    /// The state of a number that an executor wrote, if it is one.
    pub fn from_code(code: u32) -> Option<Self> {
        match code {
            0 => Some(Self::Sky),
            1 => Some(Self::Hit),
            2 => Some(Self::Unconverged),
            _ => None,
        }
    }
}

/// Work of one cell or pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Calls of the scene's estimate.
    pub evaluations: u32,
    /// Fold iterations inside them.
    pub iterations: u32,
}

/// What one pass did.
#[derive(Clone, Debug, Default)]
pub struct PassFigures {
    /// `prepare`, `march 1/16`, `trace`, `color`.
    pub name: String,
    /// Cells or pixels; places of a cone map.
    pub cells: u64,
    /// Time on the device, where it can tell.
    pub gpu_ms: Option<f64>,
    /// Time on the clock, waiting included.
    pub wall_ms: f64,
    /// Estimate evaluations, where they were counted.
    pub evaluations: Option<u64>,
    /// Fold iterations, where they were counted.
    pub iterations: Option<u64>,
}

impl PassFigures {
    /// Whether the pass is one of march and trace, which times and counts are told of.
    pub fn marches(&self) -> bool {
        self.name == "trace" || self.name.starts_with("march ")
    }
}

/// What a cone level ended with: fronts and states, row by row.
#[derive(Clone, Debug, Default)]
pub struct LevelLayer {
    /// Pixels per cell along each axis.
    pub divisor: u32,
    /// Cells along each axis.
    pub cells: [u32; 2],
    /// Distance up to which every ray of the cell is proven free.
    pub front: Vec<f32>,
    /// 0 sky, 1 stopped at something, 2 out of steps.
    pub state: Vec<u8>,
    /// Work of each cell, where it was counted.
    pub work: Vec<Work>,
}

/// A rendered picture. Layers are row-major from the upper left; those that were not
/// asked for are empty.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Pixels along each axis.
    pub size: [u32; 2],
    /// Linear radiance, red green blue.
    pub radiance: Vec<[f32; 3]>,
    /// Radial distance from the eye; infinity for sky, the distance reached where a
    /// limit stopped the ray.
    pub depth: Vec<f32>,
    /// What each pixel is, as [`State`] codes.
    pub state: Vec<u8>,
    /// Pixels, of any state but sky, whose shadow's ray reached its limit: how much light
    /// they get is a guess.
    pub undecided: usize,
    /// Unit normals in the world; zero for sky.
    pub normal: Vec<[f32; 3]>,
    /// Work of each pixel's ray, where it was counted.
    pub work: Vec<Work>,
    /// Cone levels, coarsest first, where they were kept.
    pub levels: Vec<LevelLayer>,
    /// What each pass did, in order.
    pub passes: Vec<PassFigures>,
    /// March and trace together on the clock: no compilation, no files.
    pub march_ms: f64,
}

impl Frame {
    /// Puts the figures of what was prepared before everything else.
    pub(crate) fn lead(&mut self, prepared: Vec<PassFigures>) {
        self.passes.splice(0..0, prepared);
    }

    /// Number of pixels in each state: sky, hit, unconverged.
    pub fn census(&self) -> [usize; 3] {
        let mut count = [0; 3];
        for &s in &self.state {
            count[usize::from(s).min(2)] += 1;
        }
        count
    }

    /// Evaluations and iterations of march and trace per pixel, where counted.
    pub fn work_per_pixel(&self) -> Option<(f64, f64)> {
        let mut sum = (0, 0);
        for pass in self.passes.iter().filter(|p| p.marches()) {
            sum.0 += pass.evaluations?;
            sum.1 += pass.iterations?;
        }
        let n = self.state.len().max(1);
        #[allow(clippy::cast_precision_loss, reason = "a ratio for reading")]
        Some((sum.0 as f64 / n as f64, sum.1 as f64 / n as f64))
    }

    /// Evaluations that led to each pixel: its ray's, and those of every cell above it.
    pub fn steps(&self) -> Vec<f32> {
        let width = self.size[0] as usize;
        let of = |(i, work): (usize, &Work)| {
            let (x, y) = (i % width, i / width);
            let above = self.levels.iter().filter_map(|level| {
                let d = level.divisor as usize;
                let cell = (y / d) * level.cells[0] as usize + x / d;
                level.work.get(cell).map(|w| w.evaluations)
            });
            #[allow(clippy::cast_precision_loss, reason = "counts are small")]
            let sum = (work.evaluations + above.sum::<u32>()) as f32;
            sum
        };
        self.work.iter().enumerate().map(of).collect()
    }
}
