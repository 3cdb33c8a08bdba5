// The cone walk: it finds every first hit and skips most cells (docs/method.md, 4). Over a cell
// with apex A and ratio R a ray that falls by g per texel meets no higher cell for
// x = (R (z - A) - o) / (1 + g R) texels. It goes on by x, or to the cell's exit if that is
// farther. The patch of the cell is solved if the ray comes down to A in it.

/// Starts a ray; nothing before `front` or beyond `to` counts.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    return grid_begin(o, d, front, to);
}

/// One cell: its patch if the ray comes down to it, then the larger of the cell's exit and the
/// cone's way.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let cell = (*trace).cell;
    let apex = heightmap_apex(cell);
    let exit = grid_exit(o, d, cell, cell + 1);
    let to = min(exit.x, (*trace).end);
    let z = o.z + (*trace).s * d.z;
    if min(z, o.z + to * d.z) - apex <= 0.0 {
        if grid_solve(o, d, trace, to) {
            return STATE_HIT;
        }
    }
    // The way counts from where the ray stands.
    let ratio = ratios[heightmap_number(cell)] * WALK_TRUST_RATIO;
    let next = (*trace).s + cone_way(d, ratio, z - apex, heightmap.offset) * WALK_TRUST_WAY;
    return grid_leave(o, d, trace, cell, cell + 1, 0u, exit, next);
}
