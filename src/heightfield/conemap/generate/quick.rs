//! Quick cone maps, in f64 (Valasek and Ban: Quick Cone Map Generation on the GPU,
//! Eurographics 2022). Twin: `wgsl/heightfield/conemap/generate/quick.wgsl`.
//!
//! At each level of the maxima the search looks at the eight neighbours of the node that
//! holds the place. Together they cover everything: what a level leaves out, the next
//! includes. The rules differ in where they assume the maximum of a neighbour:
//!
//! - *naive* (Algorithm 1): at the neighbour's nearest point;
//! - *improved* (Algorithm 2): at the nearest point of the part that no finer level has
//!   seen. What was seen is a rectangle, the block of 3 x 3 nodes one level down, so the
//!   rest of a neighbour is at most four rectangles, and the nearest of them counts. The
//!   code published with the paper distinguishes cases instead, and is wrong in three;
//! - *center*: at the neighbour's centre, seen along one axis alone where the neighbour
//!   lies straight ahead. Not conservative.
//!
//! Rectangles are on the unrolled plane, where a neighbour across a wrapping border has
//! indices below 0 or beyond the last. Distances to them are the shortest on the
//! wrapping grid, because another image of the same places may be nearer.

use crate::base::shader::Module;
use crate::heightfield::conemap::generate::grid_distance::{Interval, Neighbour, neighbours, node};
use crate::heightfield::conemap::generate::{Apex, Best, ConeSearch, Cost, MapTask, SearchState};
use crate::heightfield::{Heights, Patches, heights::Axis};
use crate::wgsl;

/// Where the maximum of a neighbour is assumed. The shader knows the rules by their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quick {
    /// At its nearest point.
    Naive,
    /// At the nearest point that is new.
    Improved,
    /// At its centre.
    Center,
}

/// What the nodes next to the one that holds a place cover along an axis, with it.
fn block(axis: Axis, level: u32, from: u32) -> Interval {
    let i = i64::from(from >> level);
    let end = |i| node(axis, level, i).map(|(_, at)| at);
    let own = [i64::from(from); 2];
    let seen = [
        end(i - 1).or(end(i)).unwrap_or(own)[0],
        end(i + 1).or(end(i)).unwrap_or(own)[1],
    ];
    if axis.wrap && seen[1] - seen[0] + 1 >= i64::from(axis.count) {
        // All round: nothing along this axis is new.
        return [i64::MIN, i64::MAX];
    }
    seen
}

/// The squared distance to the nearest image of a rectangle.
fn squared(axes: [Axis; 2], from: [u32; 2], node: [Interval; 2]) -> u32 {
    let [x, y] = [0, 1].map(|a| axes[a].gap(from[a], node[a]));
    x * x + y * y
}

/// The squared distance to the nearest part of a node that has not been seen.
fn unseen(
    axes: [Axis; 2],
    from: [u32; 2],
    node: [Interval; 2],
    seen: [Interval; 2],
) -> Option<u32> {
    let mut least = None;
    for a in 0..2 {
        for side in 0..2 {
            let mut part = node;
            if side == 0 {
                part[a][1] = part[a][1].min(seen[a][0].saturating_sub(1));
            } else {
                part[a][0] = part[a][0].max(seen[a][1].saturating_add(1));
            }
            if part[a][0] <= part[a][1] {
                let squared = squared(axes, from, part);
                least = Some(least.map_or(squared, |l: u32| l.min(squared)));
            }
        }
    }
    least
}

/// Twice the distance along an axis to the centre of an interval.
fn twice_to_center(axis: Axis, from: u32, at: Interval) -> u32 {
    let n = 2 * i64::from(axis.count);
    let twice = (at[0] + at[1] - 2 * i64::from(from)).abs();
    let steps = if axis.wrap {
        let rest = twice % n;
        rest.min(n - rest)
    } else {
        twice
    };
    steps as u32
}

/// Distances are in half texels, because centres lie between places.
const UNITS: f64 = 2.0;

/// The cost of a distance in quarters of a square texel. Halving is exact.
fn cost(quarters: u32, rise: f64) -> f64 {
    Cost::Cone.of(quarters, UNITS * rise)
}

impl ConeSearch for Quick {
    fn pyramids(&self, _: &Heights, _: Option<Patches>, values: &[f32]) -> Vec<Vec<f32>> {
        vec![values.to_vec()]
    }

    fn modules(&self, task: &MapTask<'_>) -> Vec<Module> {
        vec![
            task.cost().module(UNITS),
            wgsl!("heightfield/conemap/generate/least_cost.wgsl"),
            wgsl!(
                "heightfield/conemap/generate/quick.wgsl",
                "QUICK_RULE" = f64::from(*self as u8)
            ),
        ]
    }

    fn search(&self, task: &MapTask<'_>, _: usize, from: Apex, best: &mut Best) {
        let (axes, place) = (task.axes(), from.place);
        let mut seen = place.map(|i| [i64::from(i); 2]);
        for (level, maxima) in (0_u32..).zip(&task.mips[0].levels) {
            for Neighbour { at, covers, step } in neighbours(axes, level, place) {
                best.nodes += 1;
                let rise = f64::from(maxima.at(at[0], at[1])) - from.height;
                if rise <= 0.0 {
                    continue;
                }
                if let Some(quarters) = self.quarters(axes, place, covers, step, seen) {
                    best.cost = best.cost.min(cost(quarters, rise));
                }
            }
            seen = [0, 1].map(|a| block(axes[a], level, place[a]));
        }
    }

    fn found_cost(&self, _: &MapTask<'_>, found: &SearchState, height: f64) -> f64 {
        cost(found.squared, f64::from(found.top) - height)
    }
}

impl Quick {
    /// Four times the squared distance at which a neighbour counts, `step` nodes away.
    fn quarters(
        self,
        axes: [Axis; 2],
        from: [u32; 2],
        node: [Interval; 2],
        step: [i64; 2],
        seen: [Interval; 2],
    ) -> Option<u32> {
        let squared = match self {
            Self::Naive => squared(axes, from, node),
            Self::Improved => unseen(axes, from, node, seen)?,
            Self::Center => {
                let twice = |a: usize| match step[a] {
                    0 => 0,
                    _ => twice_to_center(axes[a], from[a], node[a]),
                };
                let [x, y] = [0, 1].map(twice);
                return Some(x * x + y * y);
            }
        };
        Some(4 * squared)
    }
}
