// The cone walk: exact first hits, most cells skipped (docs/method.md, 4). Over a cell
// with apex A and ratio R a ray may go on for x = (R (z - A) - o) / (1 + g R) texels, g its
// fall per texel, before any higher cell can reach it; at least to the cell's exit. The
// patch of the cell is solved where the ray comes down to A in it.

/// Starts a ray; nothing before `front` or beyond `to` counts.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    return course_begin(o, d, front, to);
}

/// One cell: its patch where the ray comes down to it, then the larger of the cell's exit
/// and the cone's way.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let cell = (*trace).cell;
    let apex = relief_apex(cell);
    let exit = course_exit(o, d, cell, cell + 1);
    let to = min(exit.x, (*trace).end);
    let z = o.z + (*trace).s * d.z;
    (*trace).gap = min(z, o.z + to * d.z) - apex;
    if (*trace).gap <= 0.0 {
        if course_solve(o, d, trace, to) {
            return STATE_HIT;
        }
    }
    // The jump counts from where the ray stands, the exit is where the cell ends.
    let ratio = ratios[relief_number(cell)] * WALK_TRUST_RATIO;
    let next = (*trace).s + cone_way(d, ratio, z - apex, relief.offset) * WALK_TRUST_WAY;
    if max(next, exit.x) >= (*trace).end {
        return course_end(o, d, trace);
    }
    if next > exit.x {
        course_land(o, d, trace, next);
    } else {
        course_cross(d, trace, exit);
    }
    return STATE_MOVING;
}
