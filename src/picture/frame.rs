//! The result of a render: layers with one value per pixel, and the figures of each pass.

use crate::base::outcome::{Counts, State};
use crate::base::view::{Beam, View, footprint};
use crate::heightfield::assets::Preparation;
use crate::plan::pyramid::Block;
use crate::plan::stereo::PictureRays;
use crate::plan::{Extras, Pass, Plan};
use serde::{Serialize, Serializer};

/// What one pass did.
#[derive(Clone, Debug, Serialize)]
pub struct PassFigures {
    /// The pass; its name in JSON.
    #[serde(rename = "name", serialize_with = "pass_name")]
    pub pass: Pass,
    /// Number of cells or pixels; for a cone map, of its places.
    pub cells: u64,
    /// Time on the device, if it was measured.
    pub gpu_ms: Option<f64>,
    /// Time on the clock.
    pub wall_ms: f64,
    /// Evaluations of the estimate, if they were counted.
    pub evaluations: Option<u64>,
    /// Iterations of the formula, if they were counted.
    pub iterations: Option<u64>,
}

fn pass_name<S: Serializer>(pass: &Pass, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&pass.name())
}

impl PassFigures {
    /// A pass over so many pixels that has not run yet.
    pub fn new(pass: Pass, pixels: [u32; 2]) -> Self {
        Self {
            pass,
            cells: pass.cells(pixels).map(u64::from).iter().product(),
            gpu_ms: None,
            wall_ms: 0.0,
            evaluations: None,
            iterations: None,
        }
    }

    /// Adds what the pass did in another part of the picture.
    pub fn add(&mut self, part: &Self) {
        let sum = |a: Option<u64>, b: Option<u64>| a.zip(b).map(|(a, b)| a + b);
        self.cells += part.cells;
        self.gpu_ms = self.gpu_ms.zip(part.gpu_ms).map(|(a, b)| a + b);
        self.wall_ms += part.wall_ms;
        self.evaluations = sum(self.evaluations, part.evaluations);
        self.iterations = sum(self.iterations, part.iterations);
    }
}

/// The result of a cone level, row by row.
#[derive(Clone, Debug, Default)]
pub struct LevelLayer {
    /// Pixels per cell along each axis.
    pub divisor: u32,
    /// Cells along each axis.
    pub cells: [u32; 2],
    /// The distance up to which every ray of the cell is proven free.
    pub front: Vec<f32>,
    /// 0 sky, 1 stopped, 2 step limit reached.
    pub state: Vec<u8>,
    /// Work of each cell, if it was counted.
    pub work: Vec<Counts>,
}

/// How the host and a device worked together on a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Traffic {
    /// How often the device had nothing to do until the host had read a count: more dispatches of a
    /// stage were needed than were encoded. What a host waits between its calls does not count.
    pub drains: u32,
    /// Submissions.
    pub submissions: u32,
    /// Bytes of parameters and scene data that were written before the first submission.
    pub uploads: usize,
    /// Programs that were compiled.
    pub compilations: usize,
    /// Buffers that were created. Those of a frame on the device count as one.
    pub allocations: u32,
}

impl Traffic {
    /// Adds that of another part of the picture.
    pub fn add(&mut self, part: &Self) {
        self.drains += part.drains;
        self.submissions += part.submissions;
        self.uploads += part.uploads;
        self.compilations += part.compilations;
        self.allocations += part.allocations;
    }
}

/// A rendered picture. Layers go row by row from the upper left. A layer that was not asked for
/// is empty.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The first pixel in the whole image: that of the plan's window.
    pub origin: [u32; 2],
    /// Linear radiance: red, green, blue. If the background is transparent, that of the hits alone,
    /// times their share in the samples.
    pub radiance: Vec<[f32; 3]>,
    /// The share of each pixel's samples that hit, if the background is transparent.
    pub alpha: Vec<f32>,
    /// The variance of each pixel's luminance, the mean of its samples, if it was asked for: see
    /// [`crate::pass::variance`].
    pub variance: Vec<f32>,
    /// Distance from the eye along the ray: infinite for sky, and as far as the ray came for
    /// unconverged pixels.
    pub depth: Vec<f32>,
    /// The [`State`] of each pixel as a number.
    pub state: Vec<u8>,
    /// Number of pixels whose shadow ray reached its step limit. Their light is a guess.
    pub undecided: usize,
    /// Unit normals in the world; zero for sky.
    pub normal: Vec<[f32; 3]>,
    /// Samples of each pixel, if tiles may end before others.
    pub samples: Vec<u32>,
    /// Work of each pixel's ray, if it was counted.
    pub work: Vec<Counts>,
    /// Cone levels, coarsest first.
    pub levels: Vec<LevelLayer>,
    /// The figures of each pass, in order.
    pub passes: Vec<PassFigures>,
    /// Time of march and trace on the clock, without compilation and files.
    pub march_ms: f64,
    /// The work of host and device together; `None` on the CPU.
    pub traffic: Option<Traffic>,
}

impl Frame {
    /// An empty frame with layers of the right sizes.
    pub fn blank(plan: &Plan, extras: Extras) -> Self {
        let Block { origin, size } = plan.pixels();
        let area = match extras.unread {
            true => 0,
            false => plan.pixels().area(),
        };
        let layer = |kept: bool, count: usize| if kept { count } else { 0 };
        let mut frame = Self {
            size,
            origin,
            depth: vec![f32::INFINITY; area],
            state: vec![State::Unconverged as u8; area],
            radiance: vec![[0.0; 3]; layer(!extras.depth_only, area)],
            alpha: vec![0.0; layer(plan.is_transparent(extras), area)],
            normal: vec![[0.0; 3]; layer(extras.normals, area)],
            variance: vec![0.0; layer(plan.has_variance(extras), area)],
            samples: vec![plan.samples; layer(plan.is_adaptive() && !extras.depth_only, area)],
            work: vec![Counts::default(); layer(extras.count, area)],
            ..Self::default()
        };
        for pass in plan.passes(extras) {
            frame.passes.push(PassFigures::new(pass, size));
            if let Pass::March(level) = pass {
                let cells = level.cells(size);
                let count = area.min(cells[0] as usize * cells[1] as usize);
                frame.levels.push(LevelLayer {
                    divisor: level.divisor,
                    cells,
                    front: vec![0.0; layer(extras.levels, count)],
                    state: vec![0; layer(extras.levels, count)],
                    work: vec![Counts::default(); layer(extras.count, count)],
                });
            }
        }
        frame
    }

    /// Adds up the time of march and trace, and inserts the figures of the prepared maps, with
    /// their milliseconds, before the other passes.
    pub fn finish(&mut self, prepared: Vec<(Preparation, f64)>) {
        self.march_ms = self.marched().map(|p| p.wall_ms).sum();
        let figures = prepared.into_iter().map(|(map, wall_ms)| PassFigures {
            wall_ms,
            ..PassFigures::new(Pass::Prepare(map), self.size)
        });
        self.passes.splice(0..0, figures);
    }

    /// The figures of march and trace.
    pub fn marched(&self) -> impl Iterator<Item = &PassFigures> {
        self.passes.iter().filter(|p| p.pass.marches())
    }

    /// Number of pixels in each state: sky, hit, unconverged.
    pub fn census(&self) -> [usize; 3] {
        let mut count = [0; 3];
        for &s in &self.state {
            count[usize::from(s).min(2)] += 1;
        }
        count
    }

    /// Evaluations and iterations of march and trace per pixel, if they were counted.
    pub fn work_per_pixel(&self) -> Option<(f64, f64)> {
        let mut sum = (0, 0);
        for pass in self.marched() {
            sum.0 += pass.evaluations?;
            sum.1 += pass.iterations?;
        }
        let n = self.state.len().max(1);
        Some((sum.0 as f64 / n as f64, sum.1 as f64 / n as f64))
    }

    /// Evaluations of each pixel's ray and of all cells above it.
    pub fn steps(&self) -> Vec<f32> {
        let width = self.size[0] as usize;
        let of = |(i, work): (usize, &Counts)| {
            let (x, y) = (i % width, i / width);
            let above = self.levels.iter().filter_map(|level| {
                let d = level.divisor as usize;
                let cell = (y / d) * level.cells[0] as usize + x / d;
                level.work.get(cell).map(|w| w.evaluations)
            });
            (work.evaluations + above.sum::<u32>()) as f32
        };
        self.work.iter().enumerate().map(of).collect()
    }

    /// The ray of a pixel, counted row by row.
    pub fn ray(&self, view: &View, i: usize) -> Beam {
        view.view_ray(self.pixel(i))
    }

    /// A pixel of the whole image, counted row by row in the frame.
    pub fn pixel(&self, i: usize) -> [u32; 2] {
        let width = self.size[0] as usize;
        in_image(self.origin, [(i % width) as u32, (i / width) as u32])
    }

    /// The world position of each pixel's hit; zero for sky.
    pub fn positions(&self, rays: &PictureRays) -> Vec<[f32; 3]> {
        let at = |(i, t): (usize, &f32)| {
            if t.is_infinite() {
                return [0.0; 3];
            }
            let (eye, ray) = rays.ray(self.pixel(i));
            let p = eye + ray.at(f64::from(*t));
            p.as_vec3().to_array()
        };
        self.depth.iter().enumerate().map(at).collect()
    }
}

/// A pixel of a part of the image that begins at `origin`, as one of the whole image.
pub(crate) fn in_image(origin: [u32; 2], local: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|axis| origin[axis] + local[axis])
}

/// The signed depth error of each pixel, in footprints of the reference. It is infinite where a
/// hit is shown as sky, minus infinite where sky is shown as a hit, 0 where both are sky, and NaN
/// where either reached a limit.
pub fn errors(frame: &Frame, reference: &Frame, view: &View) -> Vec<f64> {
    const SKY: u8 = State::Sky as u8;
    const HIT: u8 = State::Hit as u8;
    let error = |i: usize| match (frame.state[i], reference.state[i]) {
        (SKY, SKY) => 0.0,
        (SKY, HIT) => f64::INFINITY,
        (HIT, SKY) => f64::NEG_INFINITY,
        (HIT, HIT) => {
            let t = f64::from(reference.depth[i]);
            let size = footprint(&frame.ray(view, i), t);
            (f64::from(frame.depth[i]) - t) / size.max(f64::MIN_POSITIVE)
        }
        _ => f64::NAN,
    };
    (0..frame.state.len()).map(error).collect()
}
