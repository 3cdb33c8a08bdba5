// The cone walk with relaxed cones: exact for every ray, wider for those that do not rise.
// Only cells that fall away along some way limit a cone, so that a jump of a ray that goes
// down or level crosses the surface once at most, and the height at its end says whether it
// did. A rising ray goes from cell to cell, and over nodes of the maxima that lie under it.

/// Starts a ray; nothing before `front` or beyond `to` counts.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    return course_begin(o, d, front, to);
}

/// A step of a rising ray at height z, which meets nothing in its cell: to the exit of the
/// largest node that lies under it, or to the end where all of them do.
fn relaxed_rise(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, z: f32) -> u32 {
    var node = maxima_node((*trace).cell, 0u);
    var level = 0u;
    while level + 1u < relief.levels {
        let wider = maxima_node((*trace).cell, level + 1u);
        if maxima[wider.at] >= z {
            break;
        }
        node = wider;
        level++;
    }
    let exit = course_exit(o, d, node.low, node.high);
    // The one node of the last level.
    let top = maxima[maxima_place(relief.levels - 1u, vec2<u32>(0u))];
    if exit.x >= (*trace).end || z > top {
        return course_end(o, d, trace);
    }
    if level == 0u {
        course_cross(d, trace, exit);
    } else {
        course_pass(o, d, trace, exit, course_lines(d, node.low, node.high));
    }
    return STATE_MOVING;
}

/// One cell as in the walk, and the look at the end of a jump.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let cell = (*trace).cell;
    let apex = relief_apex(cell);
    let end = (*trace).end;
    let exit = course_exit(o, d, cell, cell + 1);
    let to = min(exit.x, end);
    let z = o.z + (*trace).s * d.z;
    (*trace).gap = min(z, o.z + to * d.z) - apex;
    if (*trace).gap <= 0.0 {
        if course_solve(o, d, trace, to) {
            return STATE_HIT;
        }
    }
    // In this cell nothing is met: a bracket may begin at its exit.
    if d.z > 0.0 {
        return relaxed_rise(o, d, trace, z);
    }
    let ratio = ratios[relief_number(cell)] * WALK_TRUST_RATIO;
    var next = (*trace).s + cone_way(d, ratio, z - apex, relief.offset) * WALK_TRUST_WAY;
    if exit.x >= end {
        return course_end(o, d, trace);
    }
    if next <= exit.x {
        course_cross(d, trace, exit);
        return STATE_MOVING;
    }
    let ended = next >= end;
    next = min(next, end);
    // At the bottom the ray is under the surface by definition.
    if (ended && (*trace).falls == 1u) || refine_over(o, d, next) <= 0.0 {
        refine_settle(o, d, trace, vec2<f32>(exit.x, next));
        return STATE_HIT;
    }
    if ended {
        return course_end(o, d, trace);
    }
    course_land(o, d, trace, next);
    return STATE_MOVING;
}
