// First hits by the pyramid of maxima (Tevs, Ihrke, Seidel 2008): exact, needs no cone
// map. A step looks at one node. A ray above its maximum all the way over it passes on,
// and to a node twice as wide where the parent ends there too; else it goes on to where it
// comes down to the maximum and looks at the child there, or in a cell solves the patch.

/// Share of a way that f32 may use: heights are rounded by about 1e-7.
const MAX_MIP_TRUST = 1.0 - 1e-5;

/// Starts a ray at the one node over everything.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    var trace = course_begin(o, d, front, to);
    trace.level = relief.levels - 1u;
    return trace;
}

/// One node.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let level = (*trace).level;
    let node = maxima_node((*trace).cell, level);
    let low = node.low;
    let high = node.high;
    let exit = course_exit(o, d, low, high);
    let to = min(exit.x, (*trace).end);
    let z = o.z + (*trace).s * d.z;
    let maximum = maxima[node.at];
    (*trace).gap = min(z, o.z + to * d.z) - maximum;
    if (*trace).gap <= 0.0 {
        if level > 0u {
            (*trace).level = level - 1u;
            // Down to the maximum nothing can be met.
            let over = z - maximum;
            if over > 0.0 && d.z < -COURSE_FLAT {
                let next = (*trace).s + over / -d.z * MAX_MIP_TRUST;
                if next < to {
                    course_land(o, d, trace, next);
                }
            }
            return STATE_MOVING;
        }
        if course_solve(o, d, trace, to) {
            return STATE_HIT;
        }
    }
    if exit.x >= (*trace).end {
        return course_end(o, d, trace);
    }
    // Across the line, into the cell that a walk from cell to cell would come to.
    let lines = course_lines(d, low, high);
    course_pass(o, d, trace, exit, lines);
    // Up where the line ends a node of the next level too, or the tile.
    let line = select(lines.y, lines.x, exit.y == 0.0);
    let width = select(relief.cells.y, relief.cells.x, exit.y == 0.0);
    let parts = ((line % width) & ((2i << level) - 1)) == 0;
    if parts && level + 1u < relief.levels {
        (*trace).level = level + 1u;
    }
    return STATE_MOVING;
}
