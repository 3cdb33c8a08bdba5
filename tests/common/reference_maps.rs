//! Cone maps made the plainest way, every place against every other from near to far: what
//! tracers are tested with, whoever makes maps elsewhere.

use conemarch::heightfield::conemap::{ConeMap, MapKind, WIDEST};
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::Patches;

/// One place as seen from another, and how far away: every copy of it within one turn, for
/// each lies another way.
struct Offset {
    by: [i64; 2],
    distance: f64,
}

/// All offsets on a grid, nearest first; `distance` is told the steps along each axis.
fn offsets(size: [u32; 2], distance: impl Fn([i64; 2]) -> f64) -> Vec<Offset> {
    let [w, h] = size.map(i64::from);
    let all = (1 - h..h).flat_map(|y| (1 - w..w).map(move |x| [x, y]));
    let mut all: Vec<Offset> = all
        .map(|by| Offset {
            by,
            distance: distance(by),
        })
        .collect();
    all.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    all
}

/// The narrowest cone that `limits` allows over each place of a grid of heights.
fn narrowest(
    size: [u32; 2],
    wrap: [bool; 2],
    heights: &[f64],
    offsets: &[Offset],
    limits: impl Fn([i64; 2], usize) -> bool,
) -> Vec<f64> {
    let top = heights.iter().copied().fold(0.0, f64::max);
    let one = |place: usize| {
        let own = heights[place];
        let from = [
            place as i64 % i64::from(size[0]),
            place as i64 / i64::from(size[0]),
        ];
        let mut best = WIDEST;
        for offset in offsets {
            if offset.distance >= best * (top - own) {
                break;
            }
            let mut to = [from[0] + offset.by[0], from[1] + offset.by[1]];
            let mut inside = true;
            for axis in 0..2 {
                let n = i64::from(size[axis]);
                inside &= wrap[axis] || (0..n).contains(&to[axis]);
                to[axis] = to[axis].rem_euclid(n);
            }
            if !inside {
                continue;
            }
            let other = (to[1] * i64::from(size[0]) + to[0]) as usize;
            let rise = heights[other] - own;
            if rise > 0.0 && offset.distance < best * rise && limits(offset.by, other) {
                best = offset.distance / rise;
            }
        }
        best
    };
    (0..heights.len()).map(one).collect()
}

/// Steps between two cells' squares along one axis.
fn between(steps: i64) -> f64 {
    (steps.abs() - 1).max(0) as f64
}

fn over_cells(
    relief: &HeightSurface,
    kind: MapKind,
    offset: f64,
    limits: impl Fn([i64; 2], usize) -> bool,
) -> ConeMap {
    let (size, wrap) = (relief.cells(), relief.heights().wrap());
    let apexes = relief.heights().apexes(relief.patches());
    let apexes: Vec<f64> = apexes.into_iter().map(f64::from).collect();
    let far = offsets(size, |[x, y]| between(x).hypot(between(y)) + offset);
    ConeMap {
        kind,
        size,
        wrap,
        offset,
        ratios: narrowest(size, wrap, &apexes, &far, limits),
    }
}

/// Cones of the walk.
pub fn walk(relief: &HeightSurface, offset: f64) -> ConeMap {
    over_cells(relief, MapKind::Walk, offset, |_, _| true)
}

/// Relaxed cones of the walk: a cell limits if its surface falls somewhere on a way that
/// leads to it and on.
pub fn walk_relaxed(relief: &HeightSurface, offset: f64) -> ConeMap {
    let [w, h] = relief.cells().map(|n| n as i32);
    let cells = (0..h).flat_map(|y| (0..w).map(move |x| [x, y]));
    // For each sign of x and y whether the cell falls that way.
    let falls: Vec<[bool; 4]> = cells.map(|cell| falls_of(relief, cell)).collect();
    over_cells(relief, MapKind::WalkRelaxed, offset, |by, other| {
        let signs = |d: i64| match d.signum() {
            0 => &[1, -1][..],
            1 => &[1],
            _ => &[-1],
        };
        signs(by[0]).iter().any(|x| {
            let mut y = signs(by[1]).iter();
            y.any(|y| falls[other][usize::from(*x < 0) + 2 * usize::from(*y < 0)])
        })
    })
}

fn falls_of(relief: &HeightSurface, cell: [i32; 2]) -> [bool; 4] {
    let quadrant = |x: i32, y: i32| {
        if relief.patches() == Patches::Boxes {
            let own = relief.apex(cell);
            let next = |by: [i32; 2]| {
                let to = [0, 1].map(|a| i64::from(cell[a] + by[a]));
                relief.heights().at(to[0], to[1]) < own
            };
            return next([x, 0]) || next([0, y]);
        }
        let c = relief.corners(cell);
        let [x, y] = [x, y].map(f64::from);
        [
            x * (c[1] - c[0]),
            x * (c[3] - c[2]),
            y * (c[2] - c[0]),
            y * (c[3] - c[1]),
        ]
        .iter()
        .any(|rise| *rise < 0.0)
    };
    [
        quadrant(1, 1),
        quadrant(-1, 1),
        quadrant(1, -1),
        quadrant(-1, -1),
    ]
}

/// Dummer's cones, apex on a sample and clear of all others; `kind` is what they are then
/// called.
pub fn samples(relief: &HeightSurface, kind: MapKind) -> ConeMap {
    let heights = relief.heights();
    let (size, wrap) = (heights.size(), heights.wrap());
    let z: Vec<f64> = heights.data().iter().map(|h| f64::from(*h)).collect();
    let far = offsets(size, |[x, y]| (x as f64).hypot(y as f64));
    let side = |of: &dyn Fn([i64; 2]) -> bool| narrowest(size, wrap, &z, &far, |by, _| of(by));
    let ratios = if kind == MapKind::Quad {
        let sides = [
            side(&|[x, y]| x >= y.abs()),
            side(&|[x, y]| -x >= y.abs()),
            side(&|[x, y]| y >= x.abs()),
            side(&|[x, y]| -y >= x.abs()),
        ];
        (0..z.len())
            .flat_map(|i| [0, 1, 2, 3].map(|s| sides[s][i]))
            .collect()
    } else {
        side(&|_| true)
    };
    ConeMap {
        kind,
        size,
        wrap,
        offset: 0.0,
        ratios,
    }
}
