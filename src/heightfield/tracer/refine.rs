//! Refinement: from a point above the surface and a later point under it to a hit between
//! them. Twin: `wgsl/heightfield/tracer/refine.wgsl`.
//!
//! The two points are a bracket, and every way of refinement keeps it a bracket. (Policarpo
//! and Oliveira's listing 18-3 starts at the ray's origin instead, and may end anywhere.) If
//! there are several crossings, any of them may be found. Bisection and the secant method end
//! near the surface after some rounds, as in the papers. Settling bisects until few cells are
//! left, and solves these exactly. Over boxes every bracket is settled after its rounds: a
//! point near a box does not tell whether the ray meets its top or its side.

use crate::base::work::Work;
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::heights::Patches;
use crate::heightfield::tracer::contract::{LocalRay, Trace};
use crate::heightfield::tracer::grid::{
    grid_cell, grid_cross, grid_exit, grid_hit, grid_land, grid_solve, grid_uv,
};

/// How a bracket becomes a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refine {
    /// A number of bisections; the hit is the middle of the bracket that is left.
    Binary(u32),
    /// A number of secants (regula falsi): the hit is where the line between both ends crosses.
    Secant(u32),
    /// Bisections until the cells are known, then the exact solve of their patches.
    Settle,
}

/// Bisections of a bracket that settles. It begins with at most 2^16 cells and ends with a
/// small part of one, which lies in at most three cells, around a corner.
pub const SETTLE_ROUNDS: u32 = 24;
/// Cells that are solved then: three, and one in reserve.
pub const SETTLE_CELLS: u32 = 4;

/// The ray's height above the surface at s.
pub fn refine_over(surface: &HeightSurface, ray: &LocalRay, s: f64) -> f64 {
    let cell = grid_cell(surface, ray, s);
    let [u, v] = grid_uv(ray, cell, s);
    ray.height(s) - surface.height(cell, u, v)
}

/// Marks the hit in a bracket `[low, high]`: the ray is above the surface at `low`, and not at
/// `high`.
pub fn refine(
    surface: &HeightSurface,
    ray: &LocalRay,
    trace: &mut Trace,
    bracket: [f64; 2],
    how: Refine,
    work: &mut Work,
) {
    let (left, at) = match how {
        Refine::Settle => (bracket, bracket[1]),
        Refine::Binary(rounds) => binary(surface, ray, bracket, rounds, work),
        Refine::Secant(rounds) => secant(surface, ray, bracket, rounds, work),
    };
    if how == Refine::Settle || surface.patches() == Patches::Boxes {
        return settle(surface, ray, trace, left, work);
    }
    trace.cell = grid_cell(surface, ray, at);
    grid_hit(surface, ray, trace, at);
}

/// The bracket that is left, and the parameter to take for the hit.
type Refined = ([f64; 2], f64);

fn binary(
    surface: &HeightSurface,
    ray: &LocalRay,
    bracket: [f64; 2],
    rounds: u32,
    work: &mut Work,
) -> Refined {
    let mut left = bracket;
    for _ in 0..rounds {
        left = halved(surface, ray, left, work);
    }
    (left, 0.5 * (left[0] + left[1]))
}

/// The half of a bracket whose ends still lie on both sides.
fn halved(
    surface: &HeightSurface,
    ray: &LocalRay,
    [low, high]: [f64; 2],
    work: &mut Work,
) -> [f64; 2] {
    work.iterations += 1;
    let middle = 0.5 * (low + high);
    if refine_over(surface, ray, middle) <= 0.0 {
        [low, middle]
    } else {
        [middle, high]
    }
}

fn secant(
    surface: &HeightSurface,
    ray: &LocalRay,
    bracket: [f64; 2],
    rounds: u32,
    work: &mut Work,
) -> Refined {
    let [mut low, mut high] = bracket;
    let mut above = refine_over(surface, ray, low).max(0.0);
    let mut under = refine_over(surface, ray, high).min(0.0);
    let mut at = high;
    for _ in 0..rounds {
        work.iterations += 1;
        let drop = above - under;
        // With both ends on the surface the first is the hit.
        at = if drop > 0.0 {
            low + (high - low) * (above / drop)
        } else {
            low
        };
        let over = refine_over(surface, ray, at);
        if over <= 0.0 {
            (high, under) = (at, over);
        } else {
            (low, above) = (at, over);
        }
    }
    ([low, high], at)
}

fn settle(
    surface: &HeightSurface,
    ray: &LocalRay,
    trace: &mut Trace,
    bracket: [f64; 2],
    work: &mut Work,
) {
    let [mut low, mut high] = bracket;
    for _ in 0..SETTLE_ROUNDS {
        if grid_cell(surface, ray, low) == grid_cell(surface, ray, high) {
            break;
        }
        [low, high] = halved(surface, ray, [low, high], work);
    }
    grid_land(surface, ray, trace, low);
    for _ in 0..SETTLE_CELLS {
        let (exit, axis) = grid_exit(ray, trace.cell, trace.cell.map(|i| i + 1));
        if grid_solve(surface, ray, trace, exit.min(high)) {
            return;
        }
        if exit >= high {
            break;
        }
        grid_cross(ray, trace, exit, axis);
    }
    // The ray is under the surface by less than a rounding, or at the edge of a box.
    trace.cell = grid_cell(surface, ray, high);
    grid_hit(surface, ray, trace, high);
}
