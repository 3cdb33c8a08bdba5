//! Which places can limit a relaxed cone: those behind which the surface falls.
//!
//! A ray that goes down and has entered the surface comes out again only where the
//! surface falls more steeply than the ray, so a place need not keep clear of a cone
//! unless the surface beyond it, as seen from the apex, falls somewhere (the falling
//! edges of Ban, Valasek, Balint and Vad: Robust Cone Step Mapping, EGSR 2024). What
//! lies beyond depends on the quadrant alone that the ray goes to; hence one mask, and
//! one pyramid of maxima, per quadrant.
//!
//! For the walk that makes every cone exact: each jump meets the surface at most once.
//! For cones over samples it does not, as rays pass between them.

use rayon::prelude::*;

use crate::heightfield::heights::{Heights, Patches};

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

/// The heights that limit relaxed cones over samples in the direction of a quadrant.
pub fn of_samples(heights: &Heights, up: [bool; 2]) -> Vec<f32> {
    let width = heights.size()[0] as usize;
    let one = |(i, z): (usize, &f32)| {
        let (x, y) = ((i % width) as i64, (i / width) as i64);
        if sample_limits(heights, x, y, up) {
            *z
        } else {
            NO_LIMIT
        }
    };
    heights.data().par_iter().enumerate().map(one).collect()
}

/// The apexes that limit relaxed cones over cells in the direction of a quadrant.
pub fn of_cells(heights: &Heights, patches: Patches, apexes: &[f32], up: [bool; 2]) -> Vec<f32> {
    let width = heights.cells(patches)[0] as usize;
    let one = |(i, z): (usize, &f32)| {
        let (x, y) = ((i % width) as i64, (i / width) as i64);
        if cell_limits(heights, patches, x, y, up) {
            *z
        } else {
            NO_LIMIT
        }
    };
    apexes.par_iter().enumerate().map(one).collect()
}
