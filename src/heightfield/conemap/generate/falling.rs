//! Which places can limit a relaxed cone: those behind which the surface falls.
//!
//! A ray that goes down and has entered the surface comes out again only where the
//! surface falls more steeply than the ray. So a place limits a cone only if the surface
//! beyond it, as seen from the apex, falls somewhere (the falling
//! edges of Bán, Valasek, Bálint and Vad: Robust Cone Step Mapping, EGSR 2024). What
//! lies beyond depends only on the quadrant that the ray goes to. So there is one mask, and
//! one pyramid of maxima, per quadrant.
//!
//! For cones over cells this is proven: each step meets the surface at most once. For cones
//! over samples it is not, because rays pass between samples.

use rayon::prelude::*;

use crate::heightfield::{Heights, Patches};

/// The value of a place that limits nothing: lower than every height.
pub const NO_LIMIT: f32 = -1.0;

/// Whether the surface falls along an axis, or along the other, in the cell of these
/// four corners: near, beyond along the one, beyond along the other, beyond along both.
fn falls([near, x, y, both]: [f64; 4]) -> bool {
    x < near || both < y || y < near || both < x
}

/// Whether the cell beyond a sample falls somewhere, seen in the direction of a quadrant.
fn sample_limits(heights: &Heights, x: i64, y: i64, up: [bool; 2]) -> bool {
    let [dx, dy] = up.map(|up| if up { 1 } else { -1 });
    let near = heights.at(x, y);
    let corners = [
        near,
        heights.at(x + dx, y),
        heights.at(x, y + dy),
        heights.at(x + dx, y + dy),
    ];
    falls(corners)
}

/// Whether a ray to a quadrant can come out of the surface in a cell, or on leaving it.
fn cell_limits(heights: &Heights, patches: Patches, x: i64, y: i64, up: [bool; 2]) -> bool {
    match patches {
        Patches::Bilinear => {
            let c = heights.corners(patches, x, y);
            // The corner that a ray passes first comes first.
            let first = usize::from(!up[0]) + 2 * usize::from(!up[1]);
            falls([c[first], c[first ^ 1], c[first ^ 2], c[first ^ 3]])
        }
        Patches::Boxes => {
            // A wall, or an edge, to a lower box.
            let [dx, dy] = up.map(|up| if up { 1 } else { -1 });
            let own = heights.at(x, y);
            let beyond = [(x + dx, y), (x, y + dy), (x + dx, y + dy)];
            beyond.into_iter().any(|(x, y)| heights.at(x, y) < own)
        }
    }
}

/// The values of the places that limit relaxed cones in the direction of a quadrant, and
/// [`NO_LIMIT`] for the others. `cells` says what the places are cells of, if they are cells.
pub fn limits(
    heights: &Heights,
    cells: Option<Patches>,
    values: &[f32],
    up: [bool; 2],
) -> Vec<f32> {
    let width = heights.places_along(cells)[0] as usize;
    let one = |(i, z): (usize, &f32)| {
        let (x, y) = ((i % width) as i64, (i / width) as i64);
        let limits = match cells {
            Some(patches) => cell_limits(heights, patches, x, y, up),
            None => sample_limits(heights, x, y, up),
        };
        if limits { *z } else { NO_LIMIT }
    };
    values.par_iter().enumerate().map(one).collect()
}
