//! Refinement: from a point above the surface and a later point under it to a hit between
//! them. Twin: `wgsl/heightfield/tracer/refine.wgsl`.
//!
//! The two points are a bracket, and every way of refinement keeps it a bracket. (Policarpo
//! and Oliveira's listing 18-3 starts at the ray's origin instead, and may end anywhere.) If
//! there are several crossings, any of them may be found. Bisection and the secant method end
//! near the surface after some rounds, as in the papers. `Refine::Patches` bisects until
//! few cells are left, and solves these exactly. Over boxes every bracket ends so: a
//! point near a box does not tell whether the ray meets its top or its side.

use crate::base::outcome::{Counts, Step};
use crate::heightfield::Patches;
use crate::heightfield::tracer::GridRay;

/// How a bracket becomes a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refine {
    /// Bisections; the hit is the middle of the bracket that is left.
    Binary,
    /// Secants (regula falsi): the hit is where the line between both ends crosses.
    Secant,
    /// Bisections until the cells are known, then the exact solve of their patches.
    Patches,
}

/// Bisections of a bracket over patches or boxes. It begins with at most 2^16 cells and ends with a
/// small part of one, which lies in at most three cells, around a corner.
pub const BISECTIONS: u32 = 24;
/// Cells that are solved then: three, and one in reserve.
pub const SOLVED_CELLS: u32 = 4;

/// The ray's height above the surface at s.
pub fn refine_over(grid: &GridRay<'_>, s: f64) -> f64 {
    let cell = grid.cell(s);
    let [u, v] = grid.uv(cell, s);
    grid.ray.height(s) - grid.surface.height(cell, u, v)
}

/// Marks the hit in a bracket `[low, high]`: the ray is above the surface at `low`, and not at
/// `high`. Settling takes as many rounds as it needs.
pub fn refine(
    grid: &mut GridRay<'_>,
    bracket: [f64; 2],
    how: Refine,
    rounds: u32,
    work: &mut Counts,
) -> Step {
    let (left, at) = match how {
        Refine::Patches => (bracket, bracket[1]),
        Refine::Binary => refine_binary(grid, bracket, rounds, work),
        Refine::Secant => refine_secant(grid, bracket, rounds, work),
    };
    if how == Refine::Patches || grid.surface.patches() == Patches::Boxes {
        return refine_patches(grid, left, work);
    }
    refine_mark(grid, at)
}

/// The bracket that is left, and the parameter to take for the hit.
type Refined = ([f64; 2], f64);

/// Marks a hit at s, in the cell there.
fn refine_mark(grid: &mut GridRay<'_>, s: f64) -> Step {
    grid.trace.cell = grid.cell(s);
    grid.hit(s)
}

/// The half of a bracket that is a bracket.
fn halved(grid: &GridRay<'_>, [low, high]: [f64; 2], work: &mut Counts) -> [f64; 2] {
    work.iterations += 1;
    let middle = 0.5 * (low + high);
    if refine_over(grid, middle) <= 0.0 {
        [low, middle]
    } else {
        [middle, high]
    }
}

fn refine_binary(grid: &GridRay<'_>, from: [f64; 2], rounds: u32, work: &mut Counts) -> Refined {
    let left = (0..rounds).fold(from, |left, _| halved(grid, left, work));
    (left, 0.5 * (left[0] + left[1]))
}

fn refine_secant(grid: &GridRay<'_>, from: [f64; 2], rounds: u32, work: &mut Counts) -> Refined {
    let [mut low, mut high] = from;
    let mut above = refine_over(grid, low).max(0.0);
    let mut under = refine_over(grid, high).min(0.0);
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
        let over = refine_over(grid, at);
        if over <= 0.0 {
            (high, under) = (at, over);
        } else {
            (low, above) = (at, over);
        }
    }
    ([low, high], at)
}

fn refine_patches(grid: &mut GridRay<'_>, bracket: [f64; 2], work: &mut Counts) -> Step {
    let [mut low, mut high] = bracket;
    for _ in 0..BISECTIONS {
        if grid.cell(low) == grid.cell(high) {
            break;
        }
        [low, high] = halved(grid, [low, high], work);
    }
    grid.land(low);
    for _ in 0..SOLVED_CELLS {
        let over = grid.over(&grid.surface.node(grid.trace.cell, 0));
        if grid.solve(over.exit.min(high)) {
            return Step::Hit;
        }
        if over.exit >= high {
            break;
        }
        grid.cross(over.exit, over.axis);
    }
    // The ray is under the surface by less than a rounding, or at the edge of a box.
    refine_mark(grid, high)
}
