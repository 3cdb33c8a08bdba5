//! Which places bound a cone, and how far away they are.
//! Twin: `wgsl/heightfield/conemap/generate/grid_distance.wgsl`.
//!
//! Distances are between places of a grid whose axes may wrap. Distances between cells are
//! those of their nearest points. All are whole numbers or roots of whole numbers, and a node
//! of a pyramid is never farther away than a place under it.
//!
//! A cone that looks to one side meets a place of a wrapping grid only at the image that
//! lies on that side. The image in the other direction belongs to another side.

use crate::base::shader::Module;
use crate::heightfield::{heights::Axis, max_mip::Places};
use crate::wgsl;

/// Which places bound a cone, by their direction from the apex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sector {
    /// All places.
    All,
    /// The places of one quadrant, its borders included: for each axis, whether it goes up.
    Quadrant([bool; 2]),
    /// The places of the quarter about one direction, its diagonals included.
    Side {
        /// Axis of the direction.
        axis: usize,
        /// Whether the direction goes up.
        up: bool,
    },
}

impl Sector {
    /// The four quadrants.
    pub const QUADRANTS: [Self; 4] = [
        Self::Quadrant([true, true]),
        Self::Quadrant([false, true]),
        Self::Quadrant([true, false]),
        Self::Quadrant([false, false]),
    ];

    /// The four sides in the order of a quad map: +x, -x, +y, -y.
    pub const SIDES: [Self; 4] = [
        Self::Side { axis: 0, up: true },
        Self::Side { axis: 0, up: false },
        Self::Side { axis: 1, up: true },
        Self::Side { axis: 1, up: false },
    ];

    /// What the shader calls the shape of the sector, and its number among those of the shape.
    pub fn codes(self) -> [u32; 2] {
        match self {
            Self::All => [0, 0],
            Self::Quadrant([x, y]) => [1, u32::from(!x) + 2 * u32::from(!y)],
            Self::Side { axis, up } => [2, 2 * axis as u32 + u32::from(!up)],
        }
    }
}

/// Distances from places of one grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridDistance {
    /// The grid.
    pub axes: [Axis; 2],
    /// Which places count.
    pub sector: Sector,
    /// Whether places are cells, which touch their neighbours.
    pub cells: bool,
}

impl Places {
    /// The lowest and the highest along an axis.
    fn along(self, axis: usize) -> Interval {
        [self.low[axis], self.high[axis]].map(i64::from)
    }
}

/// Steps from a place to the nearest of `low..=high` in one direction, going round
/// where the axis wraps; `None` if there is none.
pub fn ahead(axis: Axis, up: bool, from: u32, low: u32, high: u32) -> Option<u32> {
    let last = axis.count - 1;
    let (from, low, high) = if up {
        (from, low, high)
    } else {
        (last - from, last - high, last - low)
    };
    if from <= high {
        Some(low.saturating_sub(from))
    } else if axis.wrap {
        Some(low + axis.count - from)
    } else {
        None
    }
}

impl GridDistance {
    /// The WGSL of these distances; which sector of its shape counts is a parameter.
    pub fn module(&self) -> Module {
        wgsl!(
            "heightfield/conemap/generate/grid_distance.wgsl",
            "DISTANCE_SECTOR" = f64::from(self.sector.codes()[0]),
            "DISTANCE_OVER_CELLS" = f64::from(u8::from(self.cells)),
        )
    }

    /// The squared distance in texels from a place to the nearest of some places that
    /// count: exact for a single place, not too far for more. `None` if none counts.
    // Inlined where all places count, which saves a third of a search. Other sectors are quicker as
    // a call.
    #[inline(always)]
    pub fn squared(&self, from: [u32; 2], to: Places) -> Option<u32> {
        match self.sector {
            Sector::All => Some(self.square(self.around(from, to))),
            _ => self.squared_in_sector(from, to),
        }
    }

    #[inline(never)]
    fn squared_in_sector(&self, from: [u32; 2], to: Places) -> Option<u32> {
        Some(self.square(match self.sector {
            Sector::All => self.around(from, to),
            Sector::Quadrant(up) => {
                let gap = |a: usize| ahead(self.axes[a], up[a], from[a], to.low[a], to.high[a]);
                [gap(0)?, gap(1)?]
            }
            Sector::Side { axis, up } => self.beside(axis, up, from, to)?,
        }))
    }

    /// The squared distance of so many steps along both axes.
    fn square(&self, steps: [u32; 2]) -> u32 {
        let [x, y] = steps.map(|n| n.saturating_sub(u32::from(self.cells)));
        // At most 3 * 8191 along an axis: far from the end of 32 bits.
        x * x + y * y
    }

    /// Steps along both axes in any direction.
    fn around(&self, from: [u32; 2], to: Places) -> [u32; 2] {
        let gap = |a: usize| self.axes[a].gap(from[a], to.along(a));
        [gap(0), gap(1)]
    }

    /// Steps along and across a side's direction.
    fn beside(&self, a: usize, up: bool, from: [u32; 2], to: Places) -> Option<[u32; 2]> {
        let (axis, b) = (self.axes[a], 1 - a);
        let along = ahead(axis, up, from[a], to.low[a], to.high[a])?;
        let across = self.axes[b].gap(from[b], to.along(b));
        if along >= across {
            return Some([along, across]);
        }
        if to.low == to.high {
            // The first image, turn by turn, that is within the quarter.
            let turns = (across - along).div_ceil(axis.count);
            return axis.wrap.then(|| [along + turns * axis.count, across]);
        }
        let farthest = if up {
            to.high[a].saturating_sub(from[a])
        } else {
            from[a].saturating_sub(to.low[a])
        };
        (axis.wrap || farthest >= across).then_some([across, across])
    }

    /// Steps from a place to the nearest place outside a block that contains it; `None`
    /// if there is none.
    pub fn outside(&self, from: [u32; 2], block: Places) -> Option<u32> {
        let mut least = None;
        for (a, at) in from.into_iter().enumerate() {
            let (low, high) = (block.low[a], block.high[a]);
            let Axis { count, wrap } = self.axes[a];
            if low == 0 && high == count - 1 {
                continue;
            }
            let down = (wrap || low > 0).then(|| at - low + 1);
            let up = (wrap || high < count - 1).then(|| high - at + 1);
            least = [least, down, up].into_iter().flatten().min();
        }
        least.map(|n| n - u32::from(self.cells))
    }
}

/// Places along an axis of the unrolled plane, both ends included; empty if the second
/// is less.
pub type Interval = [i64; 2];

/// The places under a node of a level along an axis, by the node's index on the unrolled
/// plane; `None` beyond a border. With it its index on the grid.
pub fn node(axis: Axis, level: u32, i: i64) -> Option<(u32, Interval)> {
    let n = i64::from(axis.count);
    let nodes = ((n - 1) >> level) + 1;
    if !axis.wrap && !(0..nodes).contains(&i) {
        return None;
    }
    let (turn, own) = (i.div_euclid(nodes), i.rem_euclid(nodes));
    let low = own << level;
    let high = (low + (1 << level) - 1).min(n - 1);
    Some((own as u32, [low + turn * n, high + turn * n]))
}

/// A node next to the one that holds a place.
pub struct Neighbour {
    /// Its index on the grid.
    pub at: [u32; 2],
    /// The places under it along each axis, on the unrolled plane.
    pub covers: [Interval; 2],
    /// Where it lies: -1, 0 or 1 along each axis.
    pub step: [i64; 2],
}

/// The neighbours of the node of a level that holds a place, at most eight. A node across a
/// wrapping border may be its own neighbour, which is left out.
pub fn neighbours(axes: [Axis; 2], level: u32, place: [u32; 2]) -> impl Iterator<Item = Neighbour> {
    let own = place.map(|i| i >> level);
    (0..9).filter_map(move |i| {
        let step = [i % 3 - 1, i / 3 - 1];
        let at = |a: usize| node(axes[a], level, i64::from(own[a]) + step[a]);
        let ((x, along), (y, across)) = (at(0)?, at(1)?);
        ([x, y] != own).then_some(Neighbour {
            at: [x, y],
            covers: [along, across],
            step,
        })
    })
}
