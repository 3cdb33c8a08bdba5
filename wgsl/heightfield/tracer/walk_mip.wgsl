// The cone walk for distant views: over nodes of a pyramid that are about as wide as a
// pixel. A ray above a node's maximum goes on to its exit at least, or as far as a cone lets
// it: that of the cell under it (`walk-mip`), or the node's own, with the least ratio under it
// and nothing finer to read (`cone-mip`). Over cells, as long as a texel is wider than a pixel, this is
// the walk. Over larger nodes a ray that comes down to the maximum has hit: never behind
// the first hit of the surface, and off by a node sideways at most.

/// Whether cones are those of nodes, not of cells.
override WALK_MIP_NODES: bool;

/// More than the nodes of any level are wide, in texels.
const WALK_MIP_WIDEST = 65536.0;

/// Starts a ray; nothing before `front` or beyond `to` counts.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    return course_begin(o, d, front, to);
}

/// The level whose nodes are as wide as a pixel at s, or narrower by less than half.
fn walk_mip_level(s: f32) -> u32 {
    if relief.lod <= 0.0 {
        return 0u;
    }
    let texels = clamp(s / relief.lod, 1.0, WALK_MIP_WIDEST);
    return min(firstLeadingBit(u32(texels)), relief.levels - 1u);
}

/// The hit of a node, over whose maximum the ray is by so much: where it comes down to
/// that, up to `to`, or at once.
fn walk_mip_meet(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, node: MaximaNode, over: f32, to: f32) {
    var s = (*trace).s;
    if over > 0.0 && d.z < -COURSE_FLAT {
        s = min(s + over / -d.z * WALK_TRUST_WAY, to);
        course_land(o, d, trace, s);
        // The line by which it leaves the node belongs to it.
        (*trace).cell = clamp((*trace).cell, node.low, node.high - 1);
    }
    course_hit(o, d, trace, s);
}

/// One node, or cell: whether the ray comes down to it, then the larger of its exit and the
/// cone's way.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let level = walk_mip_level((*trace).s);
    (*trace).level = level;
    let node = maxima_node((*trace).cell, level);
    let exit = course_exit(o, d, node.low, node.high);
    let to = min(exit.x, (*trace).end);
    let z = o.z + (*trace).s * d.z;
    let over = z - maxima[node.at];
    (*trace).gap = min(z, o.z + to * d.z) - maxima[node.at];
    if (*trace).gap <= 0.0 {
        if level > 0u {
            walk_mip_meet(o, d, trace, node, over, to);
            return STATE_HIT;
        }
        if course_solve(o, d, trace, to) {
            return STATE_HIT;
        }
    }
    // Maxima of cells are their apexes, and ratios lie as they do.
    var at = node.at;
    if !WALK_MIP_NODES {
        at = relief_number((*trace).cell);
    }
    let ratio = ratios[at] * WALK_TRUST_RATIO;
    let next = (*trace).s + cone_way(d, ratio, z - maxima[at], relief.offset) * WALK_TRUST_WAY;
    if max(next, exit.x) >= (*trace).end {
        return course_end(o, d, trace);
    }
    if next > exit.x {
        course_land(o, d, trace, next);
    } else if level == 0u {
        course_cross(d, trace, exit);
    } else {
        course_pass(o, d, trace, exit, course_lines(d, node.low, node.high));
    }
    return STATE_MOVING;
}
