//! Cone maps made the plainest way, every place against every other: what is compared
//! with, and what tracers are tested with. Too slow for anything else.

use conemarch::heightfield::conemap::{ConeMap, MapKind, WIDEST};
use conemarch::heightfield::relief::Relief;

/// Distances along an axis as squares see them: from a cell to the nearest point of
/// another one, going round where that is shorter.
fn gaps(count: u32, wrap: bool) -> Vec<Vec<f64>> {
    let n = i64::from(count);
    let between = |i: i64, j: i64| {
        let direct = (i - j).abs();
        let steps = if wrap { direct.min(n - direct) } else { direct };
        (steps - 1).max(0) as f64
    };
    (0..n)
        .map(|i| (0..n).map(|j| between(i, j)).collect())
        .collect()
}

/// Ratios over cells: of each against all others that `limits` names, seen from it.
fn over_cells(
    relief: &Relief,
    kind: MapKind,
    offset: f64,
    limits: impl Fn([i64; 2], [i64; 2]) -> bool,
) -> ConeMap {
    let size = relief.cells();
    let wrap = relief.heights().wrap();
    let apexes = relief.heights().apexes(relief.patches());
    let [across, down] = [0, 1].map(|a| gaps(size[a], wrap[a]));
    let mut ratios = Vec::with_capacity(apexes.len());
    for y in 0..size[1] as usize {
        for x in 0..size[0] as usize {
            let apex = f64::from(apexes[y * size[0] as usize + x]);
            let mut best = WIDEST;
            for (at, other) in apexes.iter().enumerate() {
                let rise = f64::from(*other) - apex;
                if rise <= 0.0 {
                    continue;
                }
                let (i, j) = (at % size[0] as usize, at / size[0] as usize);
                let ratio = (across[x][i].hypot(down[y][j]) + offset) / rise;
                let [from, to] = [[x, y], [i, j]].map(|c| c.map(|n| n as i64));
                if ratio < best && limits(from, to) {
                    best = ratio;
                }
            }
            ratios.push(best);
        }
    }
    ConeMap {
        kind,
        size,
        wrap,
        offset,
        ratios,
    }
}

/// Cones of the walk.
pub fn walk(relief: &Relief, offset: f64) -> ConeMap {
    over_cells(relief, MapKind::Walk, offset, |_, _| true)
}
