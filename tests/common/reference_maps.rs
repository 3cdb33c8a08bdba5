//! Cone maps straight from their definitions, without any function of the generators: each
//! place is compared with all others, from near to far.

use conemarch::heightfield::conemap::{ConeMap, MapKind, WIDEST};
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::{Heights, Patches};

/// A grid of heights that is read at any index.
pub struct Grid {
    pub size: [i64; 2],
    pub wrap: [bool; 2],
    pub values: Vec<f64>,
}

impl Grid {
    pub fn samples(heights: &Heights) -> Self {
        Self {
            size: heights.size().map(i64::from),
            wrap: heights.wrap(),
            values: heights.data().iter().map(|z| f64::from(*z)).collect(),
        }
    }

    /// The cells between samples, each as high as its highest corner.
    pub fn cells(heights: &Heights, patches: Patches) -> Self {
        let samples = Self::samples(heights);
        let size = [0, 1].map(|a| match patches {
            Patches::Bilinear if !samples.wrap[a] => (samples.size[a] - 1).max(1),
            _ => samples.size[a],
        });
        let cells = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
        let apex = |at| samples.corners(patches, at).into_iter().fold(0.0, f64::max);
        Self {
            size,
            wrap: samples.wrap,
            values: cells.map(apex).collect(),
        }
    }

    /// The index of a place, if it is on the grid.
    pub fn index(&self, at: [i64; 2]) -> Option<usize> {
        let on = |a: usize| self.wrap[a] || (0..self.size[a]).contains(&at[a]);
        let [x, y] = [0, 1].map(|a| at[a].rem_euclid(self.size[a]));
        (on(0) && on(1)).then_some((y * self.size[0] + x) as usize)
    }

    /// The height at a place; beyond a border that of the border.
    fn at(&self, at: [i64; 2]) -> f64 {
        let inside = |a: usize| match self.wrap[a] {
            true => at[a].rem_euclid(self.size[a]),
            false => at[a].clamp(0, self.size[a] - 1),
        };
        self.values[(inside(1) * self.size[0] + inside(0)) as usize]
    }

    /// The corners of a cell: (0, 0), (1, 0), (0, 1), (1, 1).
    fn corners(&self, patches: Patches, [x, y]: [i64; 2]) -> [f64; 4] {
        let last = i64::from(patches == Patches::Bilinear);
        [[0, 0], [last, 0], [0, last], [last, last]].map(|[u, v]| self.at([x + u, y + v]))
    }

    /// The widest cones that no place limits. A place limits those from which it lies at a
    /// step with `limits(step, place)`. Over cells, `offset` is the room that distances
    /// include. `far` is for cones to one side, which may meet a place of a wrapping axis
    /// only at an image that is farther away than one turn.
    pub fn cones(
        &self,
        offset: Option<f64>,
        far: bool,
        limits: impl Fn([i64; 2], usize) -> bool,
    ) -> Vec<f64> {
        // Costs are in the order of ratios; over samples they are their squares.
        let cost = |step: [i64; 2], rise: f64| match offset {
            None => (step[0] * step[0] + step[1] * step[1]) as f64 / (rise * rise),
            Some(offset) => {
                // Between the nearest points of two cells.
                let [x, y] = step.map(|n| (n.abs() - 1).max(0));
                (((x * x + y * y) as f64).sqrt() + offset) / rise
            }
        };
        let more = |a: usize| self.size[1 - a] * i64::from(far && self.wrap[a]);
        let reach = [0, 1].map(|a| self.size[a] + more(a));
        let rows = 1 - reach[1]..reach[1];
        let steps = rows.flat_map(|y| (1 - reach[0]..reach[0]).map(move |x| [x, y]));
        let mut steps: Vec<[i64; 2]> = steps.collect();
        steps.sort_by(|a, b| cost(*a, 1.0).total_cmp(&cost(*b, 1.0)));
        let top = self.values.iter().copied().fold(0.0, f64::max);
        let widest = if offset.is_some() {
            WIDEST
        } else {
            WIDEST * WIDEST
        };
        let one = |(i, own): (usize, &f64)| {
            let from = [i as i64 % self.size[0], i as i64 / self.size[0]];
            let mut best = widest;
            for step in &steps {
                // Nothing farther away matters, either.
                if cost(*step, top - own) >= best {
                    break;
                }
                let Some(to) = self.index([from[0] + step[0], from[1] + step[1]]) else {
                    continue;
                };
                let rise = self.values[to] - own;
                if rise > 0.0 && cost(*step, rise) < best && limits(*step, to) {
                    best = cost(*step, rise);
                }
            }
            let ratio = if offset.is_some() { best } else { best.sqrt() };
            ratio.min(WIDEST)
        };
        self.values.iter().enumerate().map(one).collect()
    }
}

/// The four combinations of signs, by the bits of a number.
fn signs(i: usize) -> [i64; 2] {
    [0, 1].map(|a| if i >> a & 1 == 0 { 1 } else { -1 })
}

/// Whether a place limits a relaxed cone at some step: the surface falls behind it, in a
/// quadrant that the step goes to.
fn limits_relaxed(
    size: [i64; 2],
    falls: impl Fn([i64; 2], [i64; 2]) -> bool,
) -> impl Fn([i64; 2], usize) -> bool {
    let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
    let falls: Vec<[bool; 4]> = places
        .map(|at| [0, 1, 2, 3].map(|i| falls(at, signs(i))))
        .collect();
    move |step, place| {
        (0..4).any(|i| {
            let [x, y] = signs(i);
            step[0] * x >= 0 && step[1] * y >= 0 && falls[place][i]
        })
    }
}

/// The exact map of a kind. `offset` is the room that cones over cells leave.
pub fn of(heights: &Heights, patches: Patches, kind: MapKind, offset: f64) -> ConeMap {
    let samples = Grid::samples(heights);
    let cells = Grid::cells(heights, patches);
    let (grid, ratios) = match kind {
        MapKind::Samples => (&samples, samples.cones(None, false, |_, _| true)),
        MapKind::Quad => {
            let sides = [0, 1, 2, 3].map(|side| {
                samples.cones(None, true, |[x, y], _| {
                    [x >= y.abs(), -x >= y.abs(), y >= x.abs(), -y >= x.abs()][side]
                })
            });
            let places = 0..samples.values.len();
            let ratios = places.flat_map(|i| [0, 1, 2, 3].map(|side| sides[side][i]));
            (&samples, ratios.collect())
        }
        MapKind::Relaxed => {
            // A sample limits if the cell beyond it falls along either axis.
            let limits = limits_relaxed(samples.size, |[x, y], [sx, sy]| {
                let z = |u: i64, v: i64| samples.at([x + u * sx, y + v * sy]);
                (0..2).any(|k| z(1, k) < z(0, k) || z(k, 1) < z(k, 0))
            });
            (&samples, samples.cones(None, false, limits))
        }
        MapKind::Walk => (&cells, cells.cones(Some(offset), false, |_, _| true)),
        MapKind::WalkRelaxed => {
            let limits = limits_relaxed(cells.size, |[x, y], [sx, sy]| match patches {
                // The slopes of a patch are steepest at its edges.
                Patches::Bilinear => {
                    let c = samples.corners(patches, [x, y]);
                    let along = [c[1] - c[0], c[3] - c[2]].map(|d| d * sx as f64);
                    let across = [c[2] - c[0], c[3] - c[1]].map(|d| d * sy as f64);
                    along.into_iter().chain(across).any(|d| d < 0.0)
                }
                // A box is left through a wall, or over a corner.
                Patches::Boxes => [[sx, 0], [0, sy], [sx, sy]]
                    .iter()
                    .any(|[u, v]| samples.at([x + u, y + v]) < samples.at([x, y])),
            });
            (&cells, cells.cones(Some(offset), false, limits))
        }
    };
    ConeMap {
        kind,
        size: grid.size.map(|n| n as u32),
        wrap: grid.wrap,
        offset: if std::ptr::eq(grid, &cells) {
            offset
        } else {
            0.0
        },
        ratios,
    }
}

/// Cones of the walk over a height surface.
pub fn walk(surface: &HeightSurface, offset: f64) -> ConeMap {
    of(surface.heights(), surface.patches(), MapKind::Walk, offset)
}

/// Relaxed cones of the walk over a height surface.
pub fn walk_relaxed(surface: &HeightSurface, offset: f64) -> ConeMap {
    let kind = MapKind::WalkRelaxed;
    of(surface.heights(), surface.patches(), kind, offset)
}

/// Empty cones over samples, four or one to a sample, under the name of a kind.
pub fn samples(surface: &HeightSurface, kind: MapKind) -> ConeMap {
    let made = match kind {
        MapKind::Quad => MapKind::Quad,
        _ => MapKind::Samples,
    };
    let map = of(surface.heights(), surface.patches(), made, 0.0);
    ConeMap { kind, ..map }
}
