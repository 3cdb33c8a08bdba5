//! Cone maps by comparing every pair of places: slow, and hardly to be got wrong.

use conemarch::heightfield::conemap::{ConeMap, MapKind, WIDEST};
use conemarch::heightfield::heights::{Axis, Heights, Patches};

/// Places of a map with their heights: samples, or cells with their highest points.
pub struct Places {
    pub size: [u32; 2],
    pub wrap: [bool; 2],
    pub heights: Vec<f32>,
    /// Room that distances carry.
    pub offset: f64,
}

impl Places {
    /// Those of a kind of map.
    pub fn of(heights: &Heights, kind: MapKind, offset: f64) -> Self {
        let walk = matches!(kind, MapKind::Walk | MapKind::WalkRelaxed);
        Self {
            size: if walk {
                heights.cells(Patches::Bilinear)
            } else {
                heights.size()
            },
            wrap: heights.wrap(),
            heights: if walk {
                heights.apexes(Patches::Bilinear)
            } else {
                heights.data().to_vec()
            },
            offset: if walk { offset } else { 0.0 },
        }
    }

    fn apart(&self, a: usize, b: usize) -> f64 {
        let width = self.size[0] as usize;
        let gap = |axis: usize, i: usize, j: usize| {
            let axis = Axis {
                count: self.size[axis],
                wrap: self.wrap[axis],
            };
            f64::from(axis.gap(i as u32, j as u32, j as u32))
        };
        let x = gap(0, a % width, b % width);
        let y = gap(1, a / width, b / width);
        x.hypot(y) + self.offset
    }

    /// The widest cones that keep all others out.
    pub fn cones(&self) -> Vec<f64> {
        let all = 0..self.heights.len();
        let one = |a: usize| {
            let others = all.clone().filter_map(|b| {
                let rise = f64::from(self.heights[b]) - f64::from(self.heights[a]);
                (rise > 0.0).then(|| self.apart(a, b) / rise)
            });
            others.fold(WIDEST, f64::min)
        };
        all.clone().map(one).collect()
    }

    /// The pair of apex and other that a cone fails most, as how many times too wide it
    /// is; 1 and less if all are empty.
    pub fn widest(&self, ratios: &[f64]) -> f64 {
        let best = self.cones();
        let share = ratios.iter().zip(best).map(|(r, best)| r / best);
        share.fold(0.0, f64::max)
    }
}

/// A map of a kind, with four equal cones for quads.
pub fn map(heights: &Heights, kind: MapKind, offset: f64) -> ConeMap {
    let places = Places::of(heights, kind, offset);
    let per_place = if kind == MapKind::Quad { 4 } else { 1 };
    let ratios = places.cones().into_iter();
    ConeMap {
        kind,
        size: places.size,
        wrap: places.wrap,
        offset: places.offset,
        ratios: ratios.flat_map(|r| vec![r; per_place]).collect(),
    }
}
