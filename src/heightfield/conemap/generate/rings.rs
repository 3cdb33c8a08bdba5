//! All places around one, in growing square rings.
//! Twin: `wgsl/heightfield/conemap/generate/rings.wgsl`.
//!
//! Each place is visited once, at its nearest image where axes wrap (of two equally near, at
//! the lower one). So no corner beyond two borders is missed, and none counts twice.

use crate::heightfield::conemap::generate::{Apex, Best, Cost, MapTask};
use crate::heightfield::heights::Axis;

/// The least and the greatest step from a place along an axis.
pub fn span(axis: Axis, from: u32) -> [i64; 2] {
    let (n, from) = (i64::from(axis.count), i64::from(from));
    if axis.wrap {
        [-(n / 2), (n - 1) / 2]
    } else {
        [-from, n - 1 - from]
    }
}

/// Visits the steps to all other samples, ring by ring, until no place that far away can
/// narrow the cone.
pub fn rings(
    task: &MapTask<'_>,
    from: Apex,
    best: &mut Best,
    mut visit: impl FnMut(&mut Best, [i64; 2]),
) {
    let axes = task.axes();
    let rise = f64::from(task.top(0)) - from.height;
    if rise <= 0.0 {
        return;
    }
    let mut visit = |best: &mut Best, step| {
        best.nodes = best.nodes.saturating_add(1);
        visit(best, step);
    };
    let [x, y] = [0, 1].map(|a| span(axes[a], from.place[a]));
    let last = [-x[0], x[1], -y[0], y[1]].into_iter().max().unwrap_or(0);
    for r in 1..=last {
        if Cost::Cone.of((r * r) as u32, rise) >= best.cost {
            return;
        }
        // Rows with their corners, then columns without.
        for dy in [-r, r] {
            if (y[0]..=y[1]).contains(&dy) {
                for dx in x[0].max(-r)..=x[1].min(r) {
                    visit(best, [dx, dy]);
                }
            }
        }
        for dx in [-r, r] {
            if (x[0]..=x[1]).contains(&dx) {
                for dy in y[0].max(1 - r)..=y[1].min(r - 1) {
                    visit(best, [dx, dy]);
                }
            }
        }
    }
}
