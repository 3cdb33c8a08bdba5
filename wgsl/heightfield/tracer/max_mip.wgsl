// Descent of the pyramid of maxima: it finds every first hit and needs no cone map (Tevs, Ihrke,
// Seidel 2008). A step looks at one node. If the ray stays above the node's maximum, it goes on to
// the next node, or to one that is twice as wide if the parent ends there too. Otherwise it goes on
// to where it comes down to the maximum, and looks at the child there. In a cell it solves the
// patch.

/// Share of a way that f32 may use: heights are rounded by about 1e-7.
const MAX_MIP_TRUST = 1.0 - 1e-5;

/// Starts a ray at the node over everything.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    var trace = grid_begin(o, d, front, to);
    trace.level = heightmap.levels - 1u;
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
    let exit = grid_exit(o, d, low, high);
    let to = min(exit.x, (*trace).end);
    let z = o.z + (*trace).s * d.z;
    let maximum = maxima[node.at];
    if min(z, o.z + to * d.z) - maximum <= 0.0 {
        if level > 0u {
            (*trace).level = level - 1u;
            // The ray meets nothing before it comes down to the maximum.
            let over = z - maximum;
            if over > 0.0 && d.z < -GRID_FLAT {
                let next = (*trace).s + over / -d.z * MAX_MIP_TRUST;
                if next < to {
                    grid_land(o, d, trace, next);
                }
            }
            return STATE_MOVING;
        }
        if grid_solve(o, d, trace, to) {
            return STATE_HIT;
        }
    }
    if exit.x >= (*trace).end {
        return grid_end(trace);
    }
    let lines = grid_lines(d, low, high);
    grid_pass(o, d, trace, exit, lines);
    // Up if the line also ends a node of the next level, or the tile.
    let line = select(lines.y, lines.x, exit.y == 0.0);
    let width = select(heightmap.cells.y, heightmap.cells.x, exit.y == 0.0);
    let parts = ((line % width) & ((2i << level) - 1)) == 0;
    if parts && level + 1u < heightmap.levels {
        (*trace).level = level + 1u;
    }
    return STATE_MOVING;
}
