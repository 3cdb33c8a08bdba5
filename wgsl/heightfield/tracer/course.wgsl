// The course of a ray through the cells of a block: clipping, crossing, landing and the
// solve in a cell. What all tracers share; which cells are looked at they decide.
//
// Cells are carried as integers. Where a ray crosses the line x = k is one function of k
// for all: a ray that jumps into a cell and one that walks there agree on where it
// begins, so that f32 loses no cell between two.

/// A ray on its way, whatever traces it.
struct Trace {
    /// Where it stands, where it leaves the block or ends, where it came into its cell.
    s: f32,
    end: f32,
    enter: f32,
    /// A lower bound of its height above what it was last over.
    gap: f32,
    cell: vec2<i32>,
    level: u32,
    /// Steps left to a tracer that counts its own.
    left: u32,
    /// 1 if the end is the bottom, reached from above.
    falls: u32,
    state: u32,
    id: u32,
    u: f32,
    v: f32,
    pad: u32,
}

/// A parameter beyond every other. Slopes below COURSE_FLAT count as none, so that no
/// quotient reaches it.
const COURSE_FAR = 1e30;
const COURSE_FLAT = 1e-20;
/// A start this share past a face is still on it: a few roundings.
const COURSE_ON_FACE = 5e-7;

/// Faces of a hit, above the low 28 bits of its id; 0 is the surface.
const FACE_BITS = 28u;
const FACE_WALL_X = 1u;
const FACE_WALL_Y = 3u;
const FACE_BASE = 5u;

/// Where the ray crosses two lines, one of each axis.
fn course_crossing(o: vec3<f32>, d: vec3<f32>, line: vec2<i32>) -> vec2<f32> {
    let flat = abs(d.xy) < vec2<f32>(COURSE_FLAT);
    // No division by what counts as no slope: its quotient may be no number.
    let slope = select(d.xy, vec2<f32>(1.0), flat);
    return select((vec2<f32>(line) - o.xy) / slope, vec2<f32>(COURSE_FAR), flat);
}

/// The part of the ray inside the block along each axis: nears, then fars.
fn course_within(o: vec3<f32>, d: vec3<f32>) -> array<vec3<f32>, 2> {
    let high = vec3<f32>(vec2<f32>(relief.domain), 1.0);
    let flat = abs(d) < vec3<f32>(COURSE_FLAT);
    let slope = select(d, vec3<f32>(1.0), flat);
    let a = -o / slope;
    let b = (high - o) / slope;
    // A ray that never crosses an axis' faces is between them for ever, or never.
    let between = (o >= vec3<f32>(0.0)) & (o <= high);
    let far = select(vec3<f32>(-COURSE_FAR), vec3<f32>(COURSE_FAR), between);
    return array<vec3<f32>, 2>(select(min(a, b), -far, flat), select(max(a, b), far, flat));
}

/// Starts a ray: the part of it inside the block, its first cell, and the hit where it
/// comes in through the solid.
fn course_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    let inside = course_within(o, d);
    let near = inside[0];
    let far = inside[1];
    let face = max(near.x, max(near.y, near.z));
    let start = max(front, face);
    let side = min(min(far.x, far.y), to);
    var trace = Trace(start, min(side, far.z), start, COURSE_FAR, vec2<i32>(0), 0u, 0u,
        0u, STATE_MOVING, 0u, 0.0, 0.0, 0u);
    if !(start <= trace.end && trace.end < COURSE_FAR) {
        trace.s = front;
        trace.state = STATE_SKY;
        return trace;
    }
    // Coming down to the bottom is a hit, whatever rounding says of the patch there.
    trace.falls = u32(d.z < 0.0 && far.z <= side);
    trace.cell = course_cell(o, d, start);
    let at = course_uv(o, d, trace.cell, start);
    let z = o.z + start * d.z;
    // The face that it comes in by is the last that it passes. A start on it counts as
    // outside: a caller's bounds may lie there.
    if front > face + COURSE_ON_FACE * abs(face) {
        return trace;
    }
    let under = z <= relief_height(trace.cell, at);
    if face == near.z && d.z > 0.0 {
        course_mark(&trace, FACE_BASE, at);
    } else if face == near.x && under {
        course_mark(&trace, FACE_WALL_X + u32(d.x < 0.0), vec2<f32>(at.y, z));
    } else if face == near.y && under {
        course_mark(&trace, FACE_WALL_Y + u32(d.y < 0.0), vec2<f32>(at.x, z));
    }
    return trace;
}

fn course_mark(trace: ptr<function, Trace>, face: u32, at: vec2<f32>) {
    (*trace).state = STATE_HIT;
    (*trace).id = relief_number((*trace).cell) | (face << FACE_BITS);
    (*trace).u = at.x;
    (*trace).v = at.y;
}

/// The lines of a cell, or of a rectangle of cells, that the ray comes in by and leaves by.
fn course_lines(d: vec3<f32>, first: vec2<i32>, second: vec2<i32>) -> vec2<i32> {
    return select(first, second, d.xy > vec2<f32>(0.0));
}

/// The cell of the domain that the ray is in at s: entered at s or before, left after.
/// The crossings decide, not the rounded position.
fn course_cell(o: vec3<f32>, d: vec3<f32>, s: f32) -> vec2<i32> {
    let last = relief.domain - 1;
    let p = o.xy + s * d.xy;
    let i = clamp(vec2<i32>(floor(p)), vec2<i32>(0), last);
    let step = course_lines(d, vec2<i32>(-1), vec2<i32>(1));
    let enter = course_crossing(o, d, course_lines(d, i + 1, i));
    let leave = course_crossing(o, d, course_lines(d, i, i + 1));
    let flat = abs(d.xy) < vec2<f32>(COURSE_FLAT);
    let past = select(vec2<i32>(0), step, vec2<f32>(s) >= leave);
    let before = select(vec2<i32>(0), step, vec2<f32>(s) < enter);
    return clamp(i + select(past - before, vec2<i32>(0), flat), vec2<i32>(0), last);
}

/// Where the ray leaves the rectangle of cells low..high: s, and 0 or 1 for the axis.
fn course_exit(o: vec3<f32>, d: vec3<f32>, low: vec2<i32>, high: vec2<i32>) -> vec2<f32> {
    let s = course_crossing(o, d, course_lines(d, low, high));
    return select(vec2<f32>(s.y, 1.0), vec2<f32>(s.x, 0.0), s.x <= s.y);
}

/// Moves to s, where the ray leaves its cell through an axis.
fn course_cross(d: vec3<f32>, trace: ptr<function, Trace>, exit: vec2<f32>) {
    let step = course_lines(d, vec2<i32>(-1), vec2<i32>(1));
    (*trace).cell += select(vec2<i32>(0, step.y), vec2<i32>(step.x, 0), exit.y == 0.0);
    (*trace).s = exit.x;
    (*trace).enter = exit.x;
}

/// Moves to an s beyond the cell's exit, over cells that are not looked at.
fn course_land(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, s: f32) {
    let found = course_cell(o, d, s);
    let was = (*trace).cell;
    // Never back: rounding may not undo a crossing.
    let cell = select(min(found, was), max(found, was), d.xy > vec2<f32>(0.0));
    let enter = course_crossing(o, d, course_lines(d, cell + 1, cell));
    let flat = abs(d.xy) < vec2<f32>(COURSE_FLAT);
    // A ray that crosses no line stays where it came in.
    let last = select(enter, vec2<f32>((*trace).enter), flat);
    (*trace).cell = cell;
    (*trace).s = s;
    (*trace).enter = max(max(last.x, last.y), (*trace).enter);
}

/// Moves to where the ray leaves a rectangle of cells, by one of two lines. Of lines that are
/// crossed at one s those of x come first, as from cell to cell.
fn course_pass(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, exit: vec2<f32>, lines: vec2<i32>) {
    let was = (*trace).cell;
    let forward = d.xy > vec2<f32>(0.0);
    let step = course_lines(d, vec2<i32>(-1), vec2<i32>(1));
    let by_x = exit.y == 0.0;
    let found = course_cell(o, d, exit.x);
    let near = course_crossing(o, d, course_lines(d, found + 1, found)).y;
    let early = by_x && near >= exit.x && near < COURSE_FAR;
    let place = found - select(vec2<i32>(0), vec2<i32>(0, step.y), early);
    let on = select(min(place, was), max(place, was), forward);
    let over = select(lines - 1, lines, forward);
    (*trace).cell = select(vec2<i32>(on.x, over.y), vec2<i32>(over.x, on.y), by_x);
    (*trace).s = exit.x;
    (*trace).enter = exit.x;
}

/// The place in the cell at s, 0..1. Where the ray comes into the cell at s, the
/// coordinate of the line that it crosses is exact.
fn course_uv(o: vec3<f32>, d: vec3<f32>, cell: vec2<i32>, s: f32) -> vec2<f32> {
    let at = (o.xy - vec2<f32>(cell)) + s * d.xy;
    let near = course_crossing(o, d, course_lines(d, cell + 1, cell));
    let on = (vec2<f32>(s) <= near) & (near < vec2<f32>(COURSE_FAR));
    let line = select(vec2<f32>(1.0), vec2<f32>(0.0), d.xy > vec2<f32>(0.0));
    return select(clamp(at, vec2<f32>(0.0), vec2<f32>(1.0)), line, on);
}

/// Looks for the hit in the trace's cell up to s; marks it and says so.
fn course_solve(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, to: f32) -> bool {
    let cell = (*trace).cell;
    let p = vec3<f32>(o.xy - vec2<f32>(cell), o.z);
    let s = patch_hit(relief_corners(cell), p, d, (*trace).enter, to);
    if s < PATCH_NONE {
        course_hit(o, d, trace, s);
    }
    return s < PATCH_NONE;
}

/// Marks a hit of the surface at s, in the trace's cell.
fn course_hit(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, s: f32) {
    (*trace).s = s;
    course_mark(trace, 0u, course_uv(o, d, (*trace).cell, s));
}

/// The end of the course, nothing met before: a hit of the ground, or nothing.
fn course_end(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).falls == 1u {
        course_land(o, d, trace, (*trace).end);
        course_hit(o, d, trace, (*trace).end);
    } else {
        (*trace).s = (*trace).end;
        (*trace).state = STATE_SKY;
    }
    return (*trace).state;
}

fn trace_hit(trace: Trace) -> Hit {
    return Hit(trace.s, trace.id, vec2<f32>(trace.u, trace.v));
}

fn trace_gap(trace: Trace) -> f32 {
    return trace.gap;
}
