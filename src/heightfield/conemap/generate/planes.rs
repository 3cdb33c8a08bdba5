//! Planes that lie above all heights under a node, for smooth fields.
//!
//! A maximum says how high a node is, but not where. Along a smooth crest, where many
//! places cost nearly the same, this uncertainty is of the order of the node's size, and a
//! search descends to as many places as the crest is long. The uncertainty of a plane above
//! the heights is of the order of the size squared (by the curvature), and few nodes have to
//! be opened.
//!
//! That no place under a node can narrow a cone of ratio R means `rise(v) <= |v| / R` for
//! all steps v to it. With any unit vector n, `|v| >= n.v`; so it is enough that the
//! linear function `plane(v) - height - n.v / R` is nowhere positive on the node's
//! rectangle, which its corners decide. n is the direction to the rectangle's centre.

use crate::heightfield::conemap::generate::grid_distance::{GridDistance, Sector};
use crate::heightfield::conemap::generate::{Apex, Cost};
use crate::heightfield::max_mip::{MipLevel, Places};
use crate::heightfield::{MaxMip, heights::grid};

/// How far below 0 the maximum of the linear function must be. Rounding is far less for
/// coordinates under ten thousand and gradients that heights of 0..=1 can have.
const SURE: f64 = 1e-9;

/// Coefficients of a plane `g[0] x + g[1] y + rest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Rise per texel along x and y.
    pub g: [f64; 2],
    /// Height at the grid's origin.
    pub rest: f64,
}

impl Plane {
    /// Its height over a place.
    pub fn at(&self, p: [u32; 2]) -> f64 {
        self.rest + self.g[0] * f64::from(p[0]) + self.g[1] * f64::from(p[1])
    }
}

/// A plane for every node above the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    /// By level from 1, row by row.
    levels: Vec<(u32, Vec<Plane>)>,
}

impl Planes {
    /// Planes over a pyramid, level by level: the mean gradient of the children, and as
    /// high as their planes need it at the corners of their rectangles.
    pub fn new(mip: &MaxMip) -> Self {
        let mut planes = Self { levels: Vec::new() };
        for (level, MipLevel { size, .. }) in mip.levels.iter().enumerate().skip(1) {
            let all = grid(*size).map(|node| over_children(mip, &planes, level, node));
            let all = all.collect();
            planes.levels.push((size[0], all));
        }
        planes
    }

    /// The plane of a node of level 1 or above.
    pub fn get(&self, level: usize, [x, y]: [u32; 2]) -> Plane {
        let (width, planes) = &self.levels[level - 1];
        planes[(y * width + x) as usize]
    }

    /// Whether no place under a node, which are the places `to`, can cost less than `best`.
    /// `false` where planes cannot tell.
    pub fn rule_out(
        &self,
        (distance, cost): (&GridDistance, Cost),
        from: Apex,
        (level, at): (usize, [u32; 2]),
        to: Places,
        best: f64,
    ) -> bool {
        let plane = self.get(level, at);
        let axis = |a: usize| steps(distance, a, from.place[a], to);
        let (Some(x), Some(y)) = (axis(0), axis(1)) else {
            return false;
        };
        let middle = [&x, &y].map(|s| 0.5 * (s.low + s.high));
        let length = (middle[0] * middle[0] + middle[1] * middle[1]).sqrt();
        if length == 0.0 {
            return false;
        }
        let ratio = cost.ratio(best);
        let n = middle.map(|m| m / (length * ratio));
        let mut most = plane.at(from.place) - from.height;
        for (a, Steps { low, high, turn }) in [x, y].into_iter().enumerate() {
            let slope = plane.g[a] - n[a];
            most += (slope * low).max(slope * high) + plane.g[a] * turn;
        }
        if let Cost::Walk { offset } = cost {
            // Cells are up to one texel nearer along each axis, and keep clear.
            most += n[0].abs() + n[1].abs() - offset / ratio;
        }
        most < -SURE * (1.0 + 1.0 / ratio)
    }
}

/// Steps along an axis from a place to the ends of a rectangle.
struct Steps {
    low: f64,
    high: f64,
    /// What leads from the rectangle's nearest image, which these steps go to, back to
    /// itself.
    turn: f64,
}

/// The steps to the nearest image of a rectangle; `None` where parts of it are nearer at
/// another one.
fn steps(distance: &GridDistance, a: usize, from: u32, to: Places) -> Option<Steps> {
    let axis = distance.axes[a];
    let at = f64::from(from);
    let (low, high) = (f64::from(to.low[a]) - at, f64::from(to.high[a]) - at);
    let n = f64::from(axis.count);
    let turn = match axis.wrap {
        true => n * (0.5 * (low + high) / n).round(),
        false => 0.0,
    };
    let (low, high) = (low - turn, high - turn);
    let near = distance.sector == Sector::All && low >= -0.5 * n && high <= 0.5 * n;
    (near || !axis.wrap).then_some(Steps { low, high, turn })
}

/// The plane of a node, from the planes of the levels below.
fn over_children(mip: &MaxMip, below: &Planes, level: usize, node: [u32; 2]) -> Plane {
    let size = mip.levels[level - 1].size;
    let all = [0, 1, 2, 3].map(|i| [2 * node[0] + i % 2, 2 * node[1] + i / 2]);
    let exist = |at: &&[u32; 2]| at[0] < size[0] && at[1] < size[1];
    let child = |at: [u32; 2]| {
        if level == 1 {
            let rest = f64::from(mip.levels[0].at(at[0], at[1]));
            return Plane { g: [0.0; 2], rest };
        }
        below.get(level - 1, at)
    };
    let mut g = [0.0; 2];
    if level == 1 {
        // Of a row or column less there is no gradient across it.
        let z = |i: usize| {
            f64::from(mip.levels[0].at(all[i][0].min(size[0] - 1), all[i][1].min(size[1] - 1)))
        };
        let [a, b, c, d] = [z(0), z(1), z(2), z(3)];
        g = [0.5 * (b - a + d - c), 0.5 * (c - a + d - b)];
    } else {
        let planes: Vec<Plane> = all.iter().filter(exist).map(|at| child(*at)).collect();
        for p in &planes {
            g = [0, 1].map(|a| g[a] + p.g[a] / planes.len() as f64);
        }
    }
    let mut plane = Plane { g, rest: 0.0 };
    let mut rest = f64::NEG_INFINITY;
    for at in all.iter().filter(exist) {
        let child = child(*at);
        let Places { low, high } = mip.places(level - 1, *at);
        for p in [low, [high[0], low[1]], [low[0], high[1]], high] {
            rest = rest.max(child.at(p) - plane.at(p));
        }
    }
    plane.rest = rest;
    plane
}
