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

use crate::base::parallel::collect;
use crate::heightfield::{Heights, Patches};

/// The value of a place that limits nothing: lower than every height.
pub const NO_LIMIT: f32 = -1.0;

/// Whether the surface falls along an axis, or along the other, in the cell of these
/// four corners: near, beyond along the one, beyond along the other, beyond along both.
fn falls([near, x, y, both]: [f64; 4]) -> bool {
    x < near || both < y || y < near || both < x
}

/// Whether a place limits relaxed cones in the direction of a quadrant: a sample if the cell
/// beyond it falls somewhere; a cell if a ray can come out of the surface in it, or on leaving
/// it.
fn is_limit(heights: &Heights, cells: Option<Patches>, [x, y]: [i64; 2], up: [bool; 2]) -> bool {
    let [dx, dy] = up.map(|up| if up { 1 } else { -1 });
    let beyond = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| heights.at(x + i * dx, y + j * dy));
    match cells {
        None => falls(beyond),
        Some(Patches::Bilinear) => {
            let c = heights.corners(Patches::Bilinear, x, y);
            // The corner that a ray passes first comes first.
            let first = usize::from(!up[0]) + 2 * usize::from(!up[1]);
            falls([c[first], c[first ^ 1], c[first ^ 2], c[first ^ 3]])
        }
        // A wall, or an edge, to a lower box.
        Some(Patches::Boxes) => beyond.into_iter().any(|z| z < beyond[0]),
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
    let one = |i: usize| {
        let z = &values[i];
        let place = [i % width, i / width].map(|i| i as i64);
        match is_limit(heights, cells, place, up) {
            true => *z,
            false => NO_LIMIT,
        }
    };
    collect(0..values.len(), 1, one)
}
