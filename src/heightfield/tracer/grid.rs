//! A ray's way through the grid of cells: clipping, crossing, landing, and solving a cell.
//! All tracers share it. Twin: `wgsl/heightfield/tracer/grid.wgsl`.
//!
//! A trace carries its cell as integers. Every tracer computes where a ray crosses the line
//! x = k by the same function of k, [`crossing`]. So a ray that jumps into a cell and one
//! that walks there agree on where the cell begins, and no cell is lost between two (Amanatides
//! and Woo, A fast voxel traversal algorithm, 1987, with a quotient in place of their sum of
//! steps). The tracers decide which cells to look at.

use crate::heightfield::height_surface::{HeightSurface, Node};
use crate::heightfield::patch::{CellRay, patch_hit};
use crate::heightfield::tracer::contract::{
    BASE, FACE_BITS, LocalRay, SURFACE, Step, Trace, WALL_X_LOW, WALL_Y_LOW,
};

/// A parameter beyond every other, and still finite.
pub const FAR: f64 = 1e30;
/// Slopes below this count as none, so that no quotient by a slope reaches [`FAR`].
pub const FLAT: f64 = 1e-20;

/// A start that is past a face by this share of its parameter is still on the face: a few
/// roundings of f32.
pub const ON_FACE: f64 = 5e-7;

/// The parameter at which the ray crosses a line of an axis; [`FAR`] if it never does.
pub fn crossing(ray: &LocalRay, axis: usize, line: i32) -> f64 {
    let slope = ray.axis[axis];
    if slope.abs() < FLAT {
        return FAR;
    }
    (f64::from(line) - ray.origin[axis]) / slope
}

/// The part of the ray within `0..=high` along an axis, as (near, far).
fn within(ray: &LocalRay, axis: usize, high: i32) -> (f64, f64) {
    if ray.axis[axis].abs() < FLAT {
        let inside = (0.0..=f64::from(high)).contains(&ray.origin[axis]);
        return if inside { (-FAR, FAR) } else { (FAR, -FAR) };
    }
    let (a, b) = (crossing(ray, axis, 0), crossing(ray, axis, high));
    (a.min(b), a.max(b))
}

/// Starts a ray: finds the part of it inside the block and its first cell, and marks a hit
/// where it enters through a solid face.
pub fn grid_begin(surface: &HeightSurface, ray: &LocalRay, from: f64, to: f64) -> Trace {
    let [w, h] = surface.domain();
    let (x, y, z) = (within(ray, 0, w), within(ray, 1, h), within(ray, 2, 1));
    let start = from.max(x.0).max(y.0).max(z.0);
    let side = x.1.min(y.1).min(to);
    let mut trace = Trace {
        s: start,
        end: side.min(z.1),
        enter: start,
        cell: [0, 0],
        level: 0,
        left: 0,
        // A ray that comes down to the bottom inside the domain hits, even if rounding hides
        // the crossing of the patch.
        falls: ray.axis.z < 0.0 && z.1 <= side,
        state: Step::Moving,
        id: 0,
        uv: [0.0; 2],
    };
    // Written so that a ray with NaNs is out as well.
    if !(start <= trace.end && trace.end < FAR) {
        trace.s = from;
        trace.state = Step::Out;
        return trace;
    }
    trace.cell = grid_cell(surface, ray, start);
    let [u, v] = grid_uv(ray, trace.cell, start);
    let p_z = ray.height(start);
    let under = p_z <= surface.height(trace.cell, u, v);
    // The ray enters by the last face that it passes. A start on that face counts as outside,
    // because a caller's bounds may lie there.
    let face = x.0.max(y.0).max(z.0);
    if from > face + ON_FACE * face.abs() {
        return trace;
    }
    let from_high = |axis: usize| u32::from(ray.axis[axis] < 0.0);
    if face == z.0 && ray.axis.z > 0.0 {
        mark(surface, &mut trace, BASE, [u, v]);
    } else if face == x.0 && under {
        mark(surface, &mut trace, WALL_X_LOW + from_high(0), [v, p_z]);
    } else if face == y.0 && under {
        mark(surface, &mut trace, WALL_Y_LOW + from_high(1), [u, p_z]);
    }
    trace
}

fn mark(surface: &HeightSurface, trace: &mut Trace, face: u32, uv: [f64; 2]) {
    trace.state = Step::Hit;
    trace.id = surface.number(trace.cell) | face << FACE_BITS;
    trace.uv = uv;
}

/// The cell of the domain that the ray is in at s: it enters the cell at s or before and
/// leaves it after s. [`crossing`] decides, not the rounded position.
pub fn grid_cell(surface: &HeightSurface, ray: &LocalRay, s: f64) -> [i32; 2] {
    let p = ray.at(s);
    [0, 1].map(|axis| {
        let last = surface.domain()[axis] - 1;
        let i = (p[axis].floor() as i32).clamp(0, last);
        let slope = ray.axis[axis];
        let moved = if slope >= FLAT {
            i32::from(s >= crossing(ray, axis, i + 1)) - i32::from(s < crossing(ray, axis, i))
        } else if slope <= -FLAT {
            i32::from(s < crossing(ray, axis, i + 1)) - i32::from(s >= crossing(ray, axis, i))
        } else {
            0
        };
        (i + moved).clamp(0, last)
    })
}

/// The line of an axis by which the ray leaves the rectangle of cells `low..high`.
pub fn far_line(ray: &LocalRay, axis: usize, low: [i32; 2], high: [i32; 2]) -> i32 {
    let forward = ray.axis[axis] > 0.0;
    if forward { high[axis] } else { low[axis] }
}

/// Where the ray leaves the rectangle of cells `low..high`, and through which axis.
pub fn grid_exit(ray: &LocalRay, low: [i32; 2], high: [i32; 2]) -> (f64, usize) {
    let [x, y] = [0, 1].map(|axis| crossing(ray, axis, far_line(ray, axis, low, high)));
    if x <= y { (x, 0) } else { (y, 1) }
}

/// Moves to s, where the ray leaves its cell through an axis.
pub fn grid_cross(ray: &LocalRay, trace: &mut Trace, s: f64, axis: usize) {
    trace.cell[axis] += if ray.axis[axis] > 0.0 { 1 } else { -1 };
    trace.s = s;
    trace.enter = s;
}

/// Moves to an s beyond the cell's exit, over cells that the tracer skips.
pub fn grid_land(surface: &HeightSurface, ray: &LocalRay, trace: &mut Trace, s: f64) {
    let found = grid_cell(surface, ray, s);
    // A ray along an axis crosses no line of the other one.
    let mut enter = trace.enter;
    for (axis, place) in found.into_iter().enumerate() {
        // Never back: rounding must not undo a crossing.
        let forward = ray.axis[axis] > 0.0;
        let was = trace.cell[axis];
        let cell = if forward {
            place.max(was)
        } else {
            place.min(was)
        };
        trace.cell[axis] = cell;
        if ray.axis[axis].abs() >= FLAT {
            enter = enter.max(crossing(ray, axis, cell + i32::from(!forward)));
        }
    }
    trace.s = s;
    trace.enter = enter;
}

/// Moves to s, where the ray leaves a rectangle of cells through a line of an axis. A ray that
/// crosses a line of x and one of y at the same s crosses that of x first, as it does from cell
/// to cell: so a corner leads into the neighbour along x.
pub fn grid_pass(
    surface: &HeightSurface,
    ray: &LocalRay,
    trace: &mut Trace,
    s: f64,
    axis: usize,
    line: i32,
) {
    let found = grid_cell(surface, ray, s);
    let other = 1 - axis;
    let forward = [0, 1].map(|a| ray.axis[a] > 0.0);
    let mut place = found[other];
    let near = crossing(ray, other, place + i32::from(!forward[other]));
    if axis == 0 && near >= s && near < FAR {
        place -= if forward[other] { 1 } else { -1 };
    }
    let was = trace.cell[other];
    trace.cell[other] = if forward[other] {
        place.max(was)
    } else {
        place.min(was)
    };
    trace.cell[axis] = line - i32::from(!forward[axis]);
    trace.s = s;
    trace.enter = s;
}

/// The place in the cell at s, 0..=1. If the ray enters the cell at s, the coordinate of the
/// line that it crosses is exact.
pub fn grid_uv(ray: &LocalRay, cell: [i32; 2], s: f64) -> [f64; 2] {
    let p = ray.at(s);
    [0, 1].map(|axis| {
        let i = cell[axis];
        let forward = ray.axis[axis] > 0.0;
        let near = crossing(ray, axis, i + i32::from(!forward));
        if s <= near && near < FAR {
            return f64::from(u8::from(!forward));
        }
        (p[axis] - f64::from(i)).clamp(0.0, 1.0)
    })
}

/// Looks for a hit in the trace's cell up to a parameter, and marks it. Returns whether there
/// is one.
pub fn grid_solve(surface: &HeightSurface, ray: &LocalRay, trace: &mut Trace, to: f64) -> bool {
    let [x, y] = trace.cell.map(f64::from);
    let cell_ray = CellRay {
        start: [ray.origin.x - x, ray.origin.y - y, ray.origin.z],
        slope: ray.axis.to_array(),
    };
    let found = patch_hit(surface.corners(trace.cell), cell_ray, trace.enter, to);
    if let Some(s) = found {
        grid_hit(surface, ray, trace, s);
    }
    found.is_some()
}

/// Marks a hit of the surface at s, in the trace's cell.
pub fn grid_hit(surface: &HeightSurface, ray: &LocalRay, trace: &mut Trace, s: f64) {
    trace.s = s;
    let uv = grid_uv(ray, trace.cell, s);
    mark(surface, trace, SURFACE, uv);
}

/// Ends a trace that has met nothing before: with a hit of the ground, or with none.
pub fn grid_end(surface: &HeightSurface, ray: &LocalRay, trace: &mut Trace) -> Step {
    if trace.falls {
        grid_land(surface, ray, trace, trace.end);
        grid_hit(surface, ray, trace, trace.end);
    } else {
        trace.s = trace.end;
        trace.state = Step::Out;
    }
    trace.state
}

/// The part of a ray over a node, from where the ray stands.
#[derive(Clone, Copy, Debug)]
pub struct Over {
    /// Where the ray leaves the node.
    pub exit: f64,
    /// The axis of the line by which it leaves.
    pub axis: usize,
    /// Where the part ends: at the exit, or at the end of the trace.
    pub to: f64,
    /// The ray's height where the part begins.
    pub z: f64,
    /// The least height of the part above the node's maximum.
    pub gap: f64,
}

/// The part of a ray over a node.
pub fn grid_over(ray: &LocalRay, trace: &Trace, node: &Node) -> Over {
    let (exit, axis) = grid_exit(ray, node.low, node.high);
    let to = exit.min(trace.end);
    let z = ray.height(trace.s);
    Over {
        exit,
        axis,
        to,
        z,
        gap: z.min(ray.height(to)) - node.maximum,
    }
}

/// Goes on to `next`, or to the node's exit if that is farther, after nothing was met there.
pub fn grid_leave(
    surface: &HeightSurface,
    ray: &LocalRay,
    trace: &mut Trace,
    node: &Node,
    over: &Over,
    next: f64,
) -> Step {
    let Over { exit, axis, .. } = *over;
    if next.max(exit) >= trace.end {
        return grid_end(surface, ray, trace);
    }
    if next > exit {
        grid_land(surface, ray, trace, next);
    } else if node.level == 0 {
        grid_cross(ray, trace, exit, axis);
    } else {
        let line = far_line(ray, axis, node.low, node.high);
        grid_pass(surface, ray, trace, exit, axis, line);
    }
    Step::Moving
}
