// A ray's way through the grid of cells: clipping, crossing, landing, and solving a cell. All
// tracers share it; they decide which cells to look at.
//
// A trace carries its cell as integers. Every tracer computes where a ray crosses the line x = k
// by the same function of k. So a ray that jumps into a cell and one that walks there agree on
// where the cell begins, and f32 loses no cell between two.

/// The state of a ray on its way, the same for every tracer.
struct Trace {
    /// Where the ray stands, where it leaves the block or ends, where it came into its cell.
    s: f32,
    end: f32,
    enter: f32,
    /// The level of the pyramid that the tracer looks at.
    level: u32,
    cell: vec2<i32>,
    /// Steps left, for a tracer that counts its own.
    left: u32,
    /// 1 if the end is the bottom, reached from above; 2 once the ray has met it.
    falls: u32,
    state: u32,
    /// The face that is met, once there is a hit.
    face: u32,
}

/// A parameter beyond every other. Slopes below GRID_FLAT count as none, so that no quotient by
/// a slope reaches it.
const GRID_FAR = 1e30;
const GRID_FLAT = 1e-20;
/// A start that is past a face by this share of its parameter is still on the face: a few
/// roundings.
const GRID_ON_FACE = 5e-7;

/// Faces of a hit, above the low 28 bits of its id.
const FACE_BITS = 28u;
const FACE_SURFACE = 0u;
const FACE_WALL_X = 1u;
const FACE_WALL_Y = 3u;
const FACE_BASE = 5u;

/// Where the ray crosses two lines, one of each axis.
fn grid_crossing(o: vec3<f32>, d: vec3<f32>, line: vec2<i32>) -> vec2<f32> {
    let flat = abs(d.xy) < vec2<f32>(GRID_FLAT);
    // No division by a slope that counts as none: the quotient may be NaN.
    let slope = select(d.xy, vec2<f32>(1.0), flat);
    return select((vec2<f32>(line) - o.xy) / slope, vec2<f32>(GRID_FAR), flat);
}

/// The part of the ray inside the block along each axis: nears, then fars.
fn grid_within(o: vec3<f32>, d: vec3<f32>) -> array<vec3<f32>, 2> {
    let high = vec3<f32>(vec2<f32>(heightmap.domain), 1.0);
    let flat = abs(d) < vec3<f32>(GRID_FLAT);
    let slope = select(d, vec3<f32>(1.0), flat);
    let a = -o / slope;
    let b = (high - o) / slope;
    // A ray that never crosses the faces of an axis is always between them, or never.
    let between = (o >= vec3<f32>(0.0)) & (o <= high);
    let far = select(vec3<f32>(-GRID_FAR), vec3<f32>(GRID_FAR), between);
    return array<vec3<f32>, 2>(select(min(a, b), -far, flat), select(max(a, b), far, flat));
}

/// Starts a ray: finds the part of it inside the block and its first cell, and marks a hit where
/// it enters through a solid face.
fn grid_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    let inside = grid_within(o, d);
    let near = inside[0];
    let far = inside[1];
    let face = max(near.x, max(near.y, near.z));
    let start = max(front, face);
    let side = min(min(far.x, far.y), to);
    var trace = Trace(start, min(side, far.z), start, 0u, vec2<i32>(0), 0u, 0u, STATE_MOVING, FACE_SURFACE);
    if !(start <= trace.end && trace.end < GRID_FAR) {
        trace.s = front;
        trace.state = STATE_SKY;
        return trace;
    }
    // A ray that comes down to the bottom hits, even if rounding hides the crossing of the patch.
    trace.falls = u32(d.z < 0.0 && far.z <= side);
    trace.cell = grid_cell(o, d, start);
    let at = grid_uv(o, d, trace.cell, start);
    let z = o.z + start * d.z;
    // The ray enters by the last face that it passes. A start on that face counts as outside,
    // because a caller's bounds may lie there.
    if front > face + GRID_ON_FACE * abs(face) {
        return trace;
    }
    let under = z <= heightmap_height(trace.cell, at);
    if face == near.z && d.z > 0.0 {
        grid_mark(&trace, FACE_BASE);
    } else if face == near.x && under {
        grid_mark(&trace, FACE_WALL_X + u32(d.x < 0.0));
    } else if face == near.y && under {
        grid_mark(&trace, FACE_WALL_Y + u32(d.y < 0.0));
    }
    return trace;
}

fn grid_mark(trace: ptr<function, Trace>, face: u32) {
    (*trace).state = STATE_HIT;
    (*trace).face = face;
}

/// One of two values for each axis: the first where the ray goes back, the second where it goes
/// forward.
fn grid_lines(d: vec3<f32>, first: vec2<i32>, second: vec2<i32>) -> vec2<i32> {
    return select(first, second, d.xy > vec2<f32>(0.0));
}

/// The cell of the domain that the ray is in at s: it enters the cell at s or before and leaves
/// it after s. The crossings decide, not the rounded position.
fn grid_cell(o: vec3<f32>, d: vec3<f32>, s: f32) -> vec2<i32> {
    let last = heightmap.domain - 1;
    let p = o.xy + s * d.xy;
    let i = clamp(vec2<i32>(floor(p)), vec2<i32>(0), last);
    let step = grid_lines(d, vec2<i32>(-1), vec2<i32>(1));
    let enter = grid_crossing(o, d, grid_lines(d, i + 1, i));
    let leave = grid_crossing(o, d, grid_lines(d, i, i + 1));
    let flat = abs(d.xy) < vec2<f32>(GRID_FLAT);
    let past = select(vec2<i32>(0), step, vec2<f32>(s) >= leave);
    let before = select(vec2<i32>(0), step, vec2<f32>(s) < enter);
    return clamp(i + select(past - before, vec2<i32>(0), flat), vec2<i32>(0), last);
}

/// Where the ray leaves the rectangle of cells low..high: s, and 0 or 1 for the axis.
fn grid_exit(o: vec3<f32>, d: vec3<f32>, low: vec2<i32>, high: vec2<i32>) -> vec2<f32> {
    let s = grid_crossing(o, d, grid_lines(d, low, high));
    return select(vec2<f32>(s.y, 1.0), vec2<f32>(s.x, 0.0), s.x <= s.y);
}

/// Moves to s, where the ray leaves its cell through an axis.
fn grid_cross(d: vec3<f32>, trace: ptr<function, Trace>, exit: vec2<f32>) {
    let step = grid_lines(d, vec2<i32>(-1), vec2<i32>(1));
    (*trace).cell += select(vec2<i32>(0, step.y), vec2<i32>(step.x, 0), exit.y == 0.0);
    (*trace).s = exit.x;
    (*trace).enter = exit.x;
}

/// Moves to an s beyond the cell's exit, over cells that the tracer skips.
fn grid_land(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, s: f32) {
    let found = grid_cell(o, d, s);
    let was = (*trace).cell;
    // Never back: rounding must not undo a crossing.
    let cell = select(min(found, was), max(found, was), d.xy > vec2<f32>(0.0));
    let enter = grid_crossing(o, d, grid_lines(d, cell + 1, cell));
    let flat = abs(d.xy) < vec2<f32>(GRID_FLAT);
    // A ray along an axis crosses no line of the other one.
    let last = select(enter, vec2<f32>((*trace).enter), flat);
    (*trace).cell = cell;
    (*trace).s = s;
    (*trace).enter = max(max(last.x, last.y), (*trace).enter);
}

/// Moves to where the ray leaves a rectangle of cells, by one of two lines. A ray that crosses a
/// line of x and one of y at the same s crosses that of x first, as it does from cell to cell.
fn grid_pass(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, exit: vec2<f32>, lines: vec2<i32>) {
    let was = (*trace).cell;
    let forward = d.xy > vec2<f32>(0.0);
    let step = grid_lines(d, vec2<i32>(-1), vec2<i32>(1));
    let by_x = exit.y == 0.0;
    let found = grid_cell(o, d, exit.x);
    let near = grid_crossing(o, d, grid_lines(d, found + 1, found)).y;
    let early = by_x && near >= exit.x && near < GRID_FAR;
    let place = found - select(vec2<i32>(0), vec2<i32>(0, step.y), early);
    let on = select(min(place, was), max(place, was), forward);
    let over = select(lines - 1, lines, forward);
    (*trace).cell = select(vec2<i32>(on.x, over.y), vec2<i32>(over.x, on.y), by_x);
    (*trace).s = exit.x;
    (*trace).enter = exit.x;
}

/// The place in the cell at s, 0..1. If the ray enters the cell at s, the coordinate of the line
/// that it crosses is exact.
fn grid_uv(o: vec3<f32>, d: vec3<f32>, cell: vec2<i32>, s: f32) -> vec2<f32> {
    let at = (o.xy - vec2<f32>(cell)) + s * d.xy;
    let near = grid_crossing(o, d, grid_lines(d, cell + 1, cell));
    let on = (vec2<f32>(s) <= near) & (near < vec2<f32>(GRID_FAR));
    let line = select(vec2<f32>(1.0), vec2<f32>(0.0), d.xy > vec2<f32>(0.0));
    return select(clamp(at, vec2<f32>(0.0), vec2<f32>(1.0)), line, on);
}

/// Looks for a hit in the trace's cell up to a parameter, and marks it. Returns whether there is
/// one.
fn grid_solve(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, to: f32) -> bool {
    let cell = (*trace).cell;
    let p = vec3<f32>(o.xy - vec2<f32>(cell), o.z);
    let s = patch_hit(heightmap_corners(cell), p, d, (*trace).enter, to);
    if s < PATCH_NONE {
        grid_hit(trace, s);
    }
    return s < PATCH_NONE;
}

/// Marks a hit of the surface at s, in the trace's cell.
fn grid_hit(trace: ptr<function, Trace>, s: f32) {
    (*trace).s = s;
    grid_mark(trace, FACE_SURFACE);
}

/// Ends a trace that has met nothing before: with a hit of the ground, or with none.
fn grid_end(trace: ptr<function, Trace>) -> u32 {
    (*trace).s = (*trace).end;
    if (*trace).falls == 1u {
        (*trace).falls = 2u;
        grid_mark(trace, FACE_SURFACE);
    } else {
        (*trace).state = STATE_SKY;
    }
    return (*trace).state;
}

/// Goes on to `next`, or to the exit of a node of a level if that is farther, after nothing was
/// met there. The node has the cells low..high.
fn grid_leave(
    o: vec3<f32>,
    d: vec3<f32>,
    trace: ptr<function, Trace>,
    low: vec2<i32>,
    high: vec2<i32>,
    level: u32,
    exit: vec2<f32>,
    next: f32,
) -> u32 {
    if max(next, exit.x) >= (*trace).end {
        return grid_end(trace);
    }
    if next > exit.x {
        grid_land(o, d, trace, next);
    } else if level == 0u {
        grid_cross(d, trace, exit);
    } else {
        grid_pass(o, d, trace, exit, grid_lines(d, low, high));
    }
    return STATE_MOVING;
}

/// The hit, once there is one; the place of the ray before that. Steps leave cell and place of a
/// hit to this function: a device that runs both sides of branches would find them in every step.
fn trace_hit(o: vec3<f32>, d: vec3<f32>, trace: Trace) -> Hit {
    if trace.state != STATE_HIT {
        return Hit(trace.s, 0u, vec2<f32>(0.0));
    }
    var ended = trace;
    if trace.falls == 2u {
        grid_land(o, d, &ended, trace.s);
    }
    var at = grid_uv(o, d, ended.cell, trace.s);
    // Walls have the height as their second coordinate.
    if trace.face != FACE_SURFACE && trace.face != FACE_BASE {
        at = vec2<f32>(select(at.x, at.y, trace.face < FACE_WALL_Y), o.z + trace.s * d.z);
    }
    return Hit(trace.s, heightmap_number(ended.cell) | (trace.face << FACE_BITS), at);
}
