//! From a place above the surface and a later one under it to the hit between them.
//! Twin: `wgsl/heightfield/tracer/refine.wgsl`.
//!
//! Three ways: halving and the secant give a point near the surface after a number of
//! rounds, as the papers do; settling halves until few cells are left and solves those
//! exactly. All keep the bracket: the end of one that holds no crossing is never taken
//! for a hit (Policarpo and Oliveira's listing 18-3 starts at the ray's origin instead, and
//! ends somewhere in any case). Where there are several crossings, any may be found. A place
//! near the surface of a box may be deep under its top or far from its side, and says nothing
//! of which of them the ray meets: over boxes every bracket is settled after its rounds.

use crate::base::work::Work;
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::heights::Patches;
use crate::heightfield::tracer::contract::{LocalRay, Trace};
use crate::heightfield::tracer::course::{
    course_cell, course_cross, course_exit, course_hit, course_land, course_solve, course_uv,
};

/// How a bracket becomes a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refine {
    /// So many halvings, and the middle of what is left.
    Binary(u32),
    /// So many false positions: where the straight line between the two ends crosses.
    Secant(u32),
    /// Halvings until the cells are known, then their patches.
    Settle,
}

/// Halvings of a settling bracket: it begins with at most 2^16 cells, and ends with a
/// small part of one, which at most three cells share, around a corner.
pub const SETTLE_ROUNDS: u32 = 24;
/// Cells that are solved then, one in reserve.
pub const SETTLE_CELLS: u32 = 4;

/// Height of the ray above the surface at s, in whatever cell it is there.
pub fn refine_over(relief: &HeightSurface, ray: &LocalRay, s: f64) -> f64 {
    let cell = course_cell(relief, ray, s);
    let [u, v] = course_uv(ray, cell, s);
    ray.height(s) - relief.height(cell, u, v)
}

/// Marks the hit between `low`, where the ray is above the surface, and `high`, where it
/// is not.
pub fn refine(
    relief: &HeightSurface,
    ray: &LocalRay,
    trace: &mut Trace,
    bracket: [f64; 2],
    how: Refine,
    work: &mut Work,
) {
    let (left, at) = match how {
        Refine::Settle => (bracket, bracket[1]),
        Refine::Binary(rounds) => binary(relief, ray, bracket, rounds, work),
        Refine::Secant(rounds) => secant(relief, ray, bracket, rounds, work),
    };
    if how == Refine::Settle || relief.patches() == Patches::Boxes {
        return settle(relief, ray, trace, left, work);
    }
    trace.cell = course_cell(relief, ray, at);
    course_hit(relief, ray, trace, at);
}

/// The bracket that is left, and the place to take for the hit.
type Refined = ([f64; 2], f64);

fn binary(
    relief: &HeightSurface,
    ray: &LocalRay,
    bracket: [f64; 2],
    rounds: u32,
    work: &mut Work,
) -> Refined {
    let mut left = bracket;
    for _ in 0..rounds {
        left = halved(relief, ray, left, work);
    }
    (left, 0.5 * (left[0] + left[1]))
}

/// The half of a bracket whose ends still lie on both sides.
fn halved(
    relief: &HeightSurface,
    ray: &LocalRay,
    [low, high]: [f64; 2],
    work: &mut Work,
) -> [f64; 2] {
    work.iterations += 1;
    let middle = 0.5 * (low + high);
    if refine_over(relief, ray, middle) <= 0.0 {
        [low, middle]
    } else {
        [middle, high]
    }
}

fn secant(
    relief: &HeightSurface,
    ray: &LocalRay,
    bracket: [f64; 2],
    rounds: u32,
    work: &mut Work,
) -> Refined {
    let [mut low, mut high] = bracket;
    let mut above = refine_over(relief, ray, low).max(0.0);
    let mut under = refine_over(relief, ray, high).min(0.0);
    let mut at = high;
    for _ in 0..rounds {
        work.iterations += 1;
        let drop = above - under;
        // Both ends on the surface: the first is the hit.
        at = if drop > 0.0 {
            low + (high - low) * (above / drop)
        } else {
            low
        };
        let over = refine_over(relief, ray, at);
        if over <= 0.0 {
            (high, under) = (at, over);
        } else {
            (low, above) = (at, over);
        }
    }
    ([low, high], at)
}

fn settle(
    relief: &HeightSurface,
    ray: &LocalRay,
    trace: &mut Trace,
    bracket: [f64; 2],
    work: &mut Work,
) {
    let [mut low, mut high] = bracket;
    for _ in 0..SETTLE_ROUNDS {
        if course_cell(relief, ray, low) == course_cell(relief, ray, high) {
            break;
        }
        [low, high] = halved(relief, ray, [low, high], work);
    }
    course_land(relief, ray, trace, low);
    for _ in 0..SETTLE_CELLS {
        let (exit, axis) = course_exit(ray, trace.cell, trace.cell.map(|i| i + 1));
        if course_solve(relief, ray, trace, exit.min(high)) {
            return;
        }
        if exit >= high {
            break;
        }
        course_cross(ray, trace, exit, axis);
    }
    // Under the surface by less than a rounding, or at the edge of a box.
    trace.cell = course_cell(relief, ray, high);
    course_hit(relief, ray, trace, high);
}
