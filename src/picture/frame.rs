//! The result of a render: layers of one value per pixel, and the figures of each pass.

use crate::base::view::View;
use crate::base::work::Work;
use glam::DVec3;
use serde::Serialize;

/// What one pass did.
#[derive(Clone, Debug, Default, Serialize)]
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
    /// What each pixel is, as [`State`](crate::base::work::State) codes.
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

    /// World position of each pixel's hit seen from a view; zero for sky, as normals
    /// are: only depth says how far that is.
    pub fn positions(&self, view: &View) -> Vec<[f32; 3]> {
        let width = self.size[0] as usize;
        let at = |(i, t): (usize, &f32)| {
            if t.is_infinite() {
                return [0.0; 3];
            }
            #[allow(clippy::cast_possible_truncation, reason = "indices of a u32 size")]
            let ray = view.view_ray([(i % width) as u32, (i / width) as u32]);
            let p: DVec3 = view.eye + ray.at(f64::from(*t));
            p.as_vec3().to_array()
        };
        self.depth.iter().enumerate().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::camera::Camera;

    #[test]
    fn positions_lie_on_the_rays() {
        let camera = Camera {
            eye: DVec3::new(1.0, -2.0, 3.0),
            ..Camera::default()
        };
        let view = camera.view([3, 1]);
        let frame = Frame {
            size: [3, 1],
            depth: vec![2.0, 4.0, f32::INFINITY],
            ..Frame::default()
        };
        let found = frame.positions(&view);
        for (x, t) in [(0, 2.0), (1, 4.0)] {
            let want = camera.eye + t * view.view_ray([x, 0]).axis;
            let got = DVec3::from_array(found[x as usize].map(f64::from));
            assert!((got - want).length() < 1e-6, "{got} {want}");
        }
        assert_eq!(found[2], [0.0; 3]);
    }
}
