//! Cone maps by their definitions, without pyramids, rings or any function of the
//! generators: every pair of places, and every image of it on a wrapping grid.

use conemarch::heightfield::conemap::WIDEST;
use conemarch::heightfield::heights::{Heights, Patches};

/// A grid of places: samples with their heights, or cells with their apexes.
pub struct Grid {
    /// Places along each axis.
    pub size: [i64; 2],
    /// Which axes wrap.
    pub wrap: [bool; 2],
    /// Heights row by row.
    pub values: Vec<f64>,
}

impl Grid {
    /// The samples of a height map.
    pub fn samples(heights: &Heights) -> Self {
        Self {
            size: heights.size().map(i64::from),
            wrap: heights.wrap(),
            values: heights.data().iter().map(|z| f64::from(*z)).collect(),
        }
    }

    /// The cells of a height map.
    pub fn cells(heights: &Heights, patches: Patches) -> Self {
        let size = heights.cells(patches).map(i64::from);
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let apex = |(x, y)| {
            let corners = heights.corners(patches, x, y);
            corners.into_iter().fold(0.0, f64::max)
        };
        Self {
            size,
            wrap: heights.wrap(),
            values: places.map(apex).collect(),
        }
    }

    /// The least cost for every place. `cost` has the step to an image of another place,
    /// that place, and its rise, which is positive; `None` where it does not count.
    /// Images are looked at for so many turns.
    pub fn least(
        &self,
        turns: i64,
        widest: f64,
        cost: impl Fn([i64; 2], [i64; 2], f64) -> Option<f64>,
    ) -> Vec<f64> {
        let [w, h] = self.size;
        let images = |axis: usize| if self.wrap[axis] { turns } else { 0 };
        let mut all = Vec::new();
        for i in 0..w * h {
            let mut best = widest;
            for j in 0..w * h {
                let rise = self.values[j as usize] - self.values[i as usize];
                if rise <= 0.0 {
                    continue;
                }
                for v in -images(1)..=images(1) {
                    for u in -images(0)..=images(0) {
                        let step = [j % w - i % w + u * w, j / w - i / w + v * h];
                        if let Some(cost) = cost(step, [j % w, j / w], rise) {
                            best = best.min(cost);
                        }
                    }
                }
            }
            all.push(best);
        }
        all
    }
}

/// `d^2 / rise^2`.
pub fn cone([x, y]: [i64; 2], rise: f64) -> f64 {
    (x * x + y * y) as f64 / (rise * rise)
}

/// Ratios from squares of ratios.
pub fn roots(costs: Vec<f64>) -> Vec<f64> {
    costs.into_iter().map(|c| c.sqrt().min(WIDEST)).collect()
}

/// Dummer's cones.
pub fn samples(heights: &Heights) -> Vec<f64> {
    let grid = Grid::samples(heights);
    let cost = |step, _, rise| Some(cone(step, rise));
    roots(grid.least(1, WIDEST * WIDEST, cost))
}

/// Four cones per sample: +x, -x, +y, -y.
pub fn quad(heights: &Heights) -> Vec<f64> {
    let grid = Grid::samples(heights);
    // On long grids a quarter may meet a place only after several turns.
    let turns = 2 + grid.size[0].max(grid.size[1]) / grid.size[0].min(grid.size[1]);
    let side = |i: usize| {
        roots(grid.least(turns, WIDEST * WIDEST, |step, _, rise| {
            let [x, y] = step;
            let inside = [x >= y.abs(), -x >= y.abs(), y >= x.abs(), -y >= x.abs()];
            inside[i].then(|| cone(step, rise))
        }))
    };
    let sides = [side(0), side(1), side(2), side(3)];
    (0..sides[0].len())
        .flat_map(|i| [0, 1, 2, 3].map(|s| sides[s][i]))
        .collect()
}

/// The signs that a step may go in along an axis: both if it does not.
fn signs(step: i64) -> Vec<i64> {
    match step.signum() {
        0 => vec![-1, 1],
        s => vec![s],
    }
}

/// Relaxed cones over samples: a sample counts if the surface in the cell beyond it
/// falls along either axis.
pub fn relaxed(heights: &Heights) -> Vec<f64> {
    let grid = Grid::samples(heights);
    let falls = |x: i64, y: i64, sx: i64, sy: i64| {
        let z = |u: i64, v: i64| heights.at(x + u * sx, y + v * sy);
        (0..2).any(|k| z(1, k) < z(0, k) || z(k, 1) < z(k, 0))
    };
    let cost = |step: [i64; 2], [x, y]: [i64; 2], rise| {
        let counts = signs(step[0])
            .iter()
            .any(|sx| signs(step[1]).iter().any(|sy| falls(x, y, *sx, *sy)));
        counts.then(|| cone(step, rise))
    };
    roots(grid.least(1, WIDEST * WIDEST, cost))
}

/// Distance between the nearest points of two cells.
fn between(step: [i64; 2]) -> f64 {
    let [x, y] = step.map(|n| (n.abs() - 1).max(0));
    ((x * x + y * y) as f64).sqrt()
}

/// The walk's cones.
pub fn walk(heights: &Heights, patches: Patches, offset: f64) -> Vec<f64> {
    let grid = Grid::cells(heights, patches);
    grid.least(1, WIDEST, |step, _, rise| {
        Some((between(step) + offset) / rise)
    })
}

/// The walk's cones, limited by cells out of which a ray can come.
pub fn walk_relaxed(heights: &Heights, patches: Patches, offset: f64) -> Vec<f64> {
    let grid = Grid::cells(heights, patches);
    // Slopes of a bilinear patch are steepest at its edges. A box is left through a
    // wall, or over a corner.
    let falls = |x: i64, y: i64, sx: i64, sy: i64| match patches {
        Patches::Bilinear => {
            let c = heights.corners(patches, x, y);
            let along = [c[1] - c[0], c[3] - c[2]].map(|d| d * sx as f64);
            let across = [c[2] - c[0], c[3] - c[1]].map(|d| d * sy as f64);
            along.into_iter().chain(across).any(|d| d < 0.0)
        }
        Patches::Boxes => {
            let z = heights.at(x, y);
            heights.at(x + sx, y) < z || heights.at(x, y + sy) < z || heights.at(x + sx, y + sy) < z
        }
    };
    grid.least(1, WIDEST, |step, [x, y], rise| {
        let counts = signs(step[0])
            .iter()
            .any(|sx| signs(step[1]).iter().any(|sy| falls(x, y, *sx, *sy)));
        counts.then(|| (between(step) + offset) / rise)
    })
}
