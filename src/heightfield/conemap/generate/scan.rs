//! All places around one, in growing square rings.
//! Twin: `wgsl/heightfield/conemap/generate/scan.wgsl`.
//!
//! Each place is visited once, at its nearest image where axes wrap (of two as near, at
//! the lower one); so no corner beyond two borders is missed, and none counts twice.

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

/// Visits the steps to all other places, ring by ring. Before each ring `go` is asked
/// with its radius whether any place that far can matter.
pub fn rings<T>(
    axes: [Axis; 2],
    from: [u32; 2],
    state: &mut T,
    go: impl Fn(&T, u32) -> bool,
    mut visit: impl FnMut(&mut T, [i64; 2]),
) {
    let [x, y] = [0, 1].map(|a| span(axes[a], from[a]));
    let last = [-x[0], x[1], -y[0], y[1]].into_iter().max().unwrap_or(0);
    for r in 1..=last {
        if !go(state, r as u32) {
            return;
        }
        // Rows with their corners, then columns without.
        for dy in [-r, r] {
            if (y[0]..=y[1]).contains(&dy) {
                for dx in x[0].max(-r)..=x[1].min(r) {
                    visit(state, [dx, dy]);
                }
            }
        }
        for dx in [-r, r] {
            if (x[0]..=x[1]).contains(&dx) {
                for dy in y[0].max(1 - r)..=y[1].min(r - 1) {
                    visit(state, [dx, dy]);
                }
            }
        }
    }
}
