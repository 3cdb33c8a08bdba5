// The cone walk with relaxed cones: it finds every first hit, and rays that do not rise have wider
// cones. Only cells that fall away along some way limit a cone. So a jump of a level or falling
// ray crosses the surface at most once, and the height at its end tells whether it did. A rising
// ray goes from cell to cell, and over nodes of the pyramid of maxima that lie under it.

/// Starts a ray; nothing before `front` or beyond `to` counts.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    return grid_begin(o, d, front, to);
}

/// A step of a rising ray at height z that meets nothing in its cell: to the exit of the largest
/// node that lies under it, or to its end if the whole surface lies under it.
fn relaxed_rise(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, z: f32) -> u32 {
    // The only node of the last level.
    let top = maxima[maxima_place(heightmap.levels - 1u, vec2<u32>(0u))];
    if z > top {
        return grid_end(trace);
    }
    var node = maxima_node((*trace).cell, 0u);
    var level = 0u;
    while level + 1u < heightmap.levels {
        let wider = maxima_node((*trace).cell, level + 1u);
        if maxima[wider.at] >= z {
            break;
        }
        node = wider;
        level++;
    }
    let exit = grid_exit(o, d, node.low, node.high);
    return grid_leave(o, d, trace, node.low, node.high, level, exit, exit.x);
}

/// One cell as in the cone walk, and the height at the end of a jump.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let cell = (*trace).cell;
    let apex = heightmap_apex(cell);
    let end = (*trace).end;
    let exit = grid_exit(o, d, cell, cell + 1);
    let to = min(exit.x, end);
    let z = o.z + (*trace).s * d.z;
    if min(z, o.z + to * d.z) - apex <= 0.0 {
        if grid_solve(o, d, trace, to) {
            return STATE_HIT;
        }
    }
    // The ray meets nothing in this cell, so that a bracket may begin at its exit.
    if d.z > 0.0 {
        return relaxed_rise(o, d, trace, z);
    }
    let ratio = ratios[heightmap_number(cell)] * WALK_TRUST_RATIO;
    let next = (*trace).s + cone_way(d, ratio, z - apex, heightmap.offset) * WALK_TRUST_WAY;
    if next > exit.x && exit.x < end {
        let last = min(next, end);
        // At the bottom the ray is under the surface by definition.
        if (next >= end && (*trace).falls == 1u) || refine_over(o, d, last) <= 0.0 {
            refine_patches(o, d, trace, vec2<f32>(exit.x, last));
            return STATE_HIT;
        }
    }
    return grid_leave(o, d, trace, cell, cell + 1, 0u, exit, next);
}
