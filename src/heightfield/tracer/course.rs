//! The course of a ray through the cells of a block: clipping, crossing, landing and
//! the solve in a cell. What all tracers share. Twin: `wgsl/heightfield/tracer/course.wgsl`.
//!
//! Cells are carried as integers. Where a ray crosses the line x = k is one function of
//! k, [`crossing`], for every tracer: so a ray that jumps into a cell and one that walks
//! there agree on where it begins, and no cell is lost between two (Amanatides and Woo,
//! A fast voxel traversal algorithm, 1987, with the sum of steps replaced by the quotient).
//! Which tracer looks at which cell, this file does not know.

use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::patch::{CellRay, patch_hit};
use crate::heightfield::tracer::contract::{
    BASE, FACE_BITS, LocalRay, SURFACE, Step, Trace, WALL_X_LOW, WALL_Y_LOW,
};

/// A parameter beyond every other, and still finite.
pub const FAR: f64 = 1e30;
/// A ray that changes a coordinate by less than this per unit of s never crosses a line
/// of it: no quotient by it reaches [`FAR`].
pub const FLAT: f64 = 1e-20;

/// A start this share of its parameter past a face is still on the face: a few roundings
/// of f32.
pub const ON_FACE: f64 = 5e-7;

/// Where the ray's coordinate has a value; [`FAR`] if it does not change.
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

/// Starts a ray: the part of it inside the block, its first cell, and the hit where it
/// comes in through the solid.
pub fn course_begin(relief: &HeightSurface, ray: &LocalRay, from: f64, to: f64) -> Trace {
    let [w, h] = relief.domain();
    let (x, y, z) = (within(ray, 0, w), within(ray, 1, h), within(ray, 2, 1));
    let start = from.max(x.0).max(y.0).max(z.0);
    let side = x.1.min(y.1).min(to);
    let mut trace = Trace {
        s: start,
        end: side.min(z.1),
        enter: start,
        gap: FAR,
        cell: [0, 0],
        level: 0,
        left: 0,
        // Coming down to the bottom inside the domain is a hit, whatever rounding says of
        // the patch there.
        falls: ray.axis.z < 0.0 && z.1 <= side,
        state: Step::Moving,
        id: 0,
        uv: [0.0; 2],
    };
    // Written so that a ray of no numbers is out as well.
    if !(start <= trace.end && trace.end < FAR) {
        trace.s = from;
        trace.state = Step::Out;
        return trace;
    }
    trace.cell = course_cell(relief, ray, start);
    let [u, v] = course_uv(ray, trace.cell, start);
    let p_z = ray.height(start);
    let under = p_z <= relief.height(trace.cell, u, v);
    // The face that it comes in by is the last of those that it passes. A start on it
    // counts as outside: a caller's bounds may lie there.
    let face = x.0.max(y.0).max(z.0);
    if from > face + ON_FACE * face.abs() {
        return trace;
    }
    let from_high = |axis: usize| u32::from(ray.axis[axis] < 0.0);
    if face == z.0 && ray.axis.z > 0.0 {
        mark(relief, &mut trace, BASE, [u, v]);
    } else if face == x.0 && under {
        mark(relief, &mut trace, WALL_X_LOW + from_high(0), [v, p_z]);
    } else if face == y.0 && under {
        mark(relief, &mut trace, WALL_Y_LOW + from_high(1), [u, p_z]);
    }
    trace
}

fn mark(relief: &HeightSurface, trace: &mut Trace, face: u32, uv: [f64; 2]) {
    trace.state = Step::Hit;
    trace.id = relief.number(trace.cell) | face << FACE_BITS;
    trace.uv = uv;
}

/// The cell of the domain that the ray is in at s: the one that it enters at s or before
/// and leaves after. The quotient of [`crossing`] decides, not the rounded position.
pub fn course_cell(relief: &HeightSurface, ray: &LocalRay, s: f64) -> [i32; 2] {
    let p = ray.at(s);
    [0, 1].map(|axis| {
        let last = relief.domain()[axis] - 1;
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

/// Where the ray leaves the rectangle of cells `low..high`, and through which axis.
pub fn course_exit(ray: &LocalRay, low: [i32; 2], high: [i32; 2]) -> (f64, usize) {
    let [x, y] = [0, 1].map(|axis| {
        let line = if ray.axis[axis] > 0.0 {
            high[axis]
        } else {
            low[axis]
        };
        crossing(ray, axis, line)
    });
    if x <= y { (x, 0) } else { (y, 1) }
}

/// Moves to s, where the ray leaves its cell through an axis.
pub fn course_cross(ray: &LocalRay, trace: &mut Trace, s: f64, axis: usize) {
    trace.cell[axis] += if ray.axis[axis] > 0.0 { 1 } else { -1 };
    trace.s = s;
    trace.enter = s;
}

/// Moves to an s beyond the cell's exit, over cells that are not looked at.
pub fn course_land(relief: &HeightSurface, ray: &LocalRay, trace: &mut Trace, s: f64) {
    let found = course_cell(relief, ray, s);
    // A ray that crosses no line stays where it came in.
    let mut enter = trace.enter;
    for (axis, place) in found.into_iter().enumerate() {
        // Never back: rounding may not undo a crossing.
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

/// Moves to s, where the ray leaves a rectangle of cells through a line of an axis. Of lines
/// that are crossed at one s those of x come first, as from cell to cell: a corner of the
/// rectangle leads into its neighbour, and only then across.
pub fn course_pass(
    relief: &HeightSurface,
    ray: &LocalRay,
    trace: &mut Trace,
    s: f64,
    axis: usize,
    line: i32,
) {
    let found = course_cell(relief, ray, s);
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

/// The place in the cell at s, 0..=1. Where the ray comes into the cell at s, the
/// coordinate of the line that it crosses is exact.
pub fn course_uv(ray: &LocalRay, cell: [i32; 2], s: f64) -> [f64; 2] {
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

/// Looks for the hit in the trace's cell up to s; marks it and says so.
pub fn course_solve(relief: &HeightSurface, ray: &LocalRay, trace: &mut Trace, to: f64) -> bool {
    let [x, y] = trace.cell.map(f64::from);
    let cell_ray = CellRay {
        start: [ray.origin.x - x, ray.origin.y - y, ray.origin.z],
        slope: ray.axis.to_array(),
    };
    let found = patch_hit(relief.corners(trace.cell), cell_ray, trace.enter, to);
    if let Some(s) = found {
        course_hit(relief, ray, trace, s);
    }
    found.is_some()
}

/// Marks a hit of the surface at s, in the trace's cell.
pub fn course_hit(relief: &HeightSurface, ray: &LocalRay, trace: &mut Trace, s: f64) {
    trace.s = s;
    let uv = course_uv(ray, trace.cell, s);
    mark(relief, trace, SURFACE, uv);
}

/// The end of the course, nothing met before: a hit of the ground, or nothing.
pub fn course_end(relief: &HeightSurface, ray: &LocalRay, trace: &mut Trace) -> Step {
    if trace.falls {
        course_land(relief, ray, trace, trace.end);
        course_hit(relief, ray, trace, trace.end);
    } else {
        trace.s = trace.end;
        trace.state = Step::Out;
    }
    trace.state
}
