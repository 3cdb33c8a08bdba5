// The cone walk for distant views: it steps over nodes of a pyramid that are about as wide as a
// pixel. A ray above a node's maximum goes on to the node's exit, or as far as a cone lets it.
// `walk-mip` takes the cone of the cell under the ray, `cone-mip` that of the node, with the least
// ratio under it, and reads nothing finer. While a texel is wider than a pixel the nodes are cells,
// and this is the cone walk. A ray that comes down to the maximum of a larger node hits it: never
// behind the first hit of the surface, and off by at most one node sideways.

/// Whether the cones are those of nodes instead of cells.
override WALK_MIP_NODES: bool;

/// More than the nodes of any level are wide, in texels.
const WALK_MIP_WIDEST = 65536.0;

/// Starts a ray; nothing before `front` or beyond `to` counts.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    return grid_begin(o, d, front, to);
}

/// The level whose nodes are as wide as a pixel at s, or narrower by less than half.
fn walk_mip_level(s: f32) -> u32 {
    if heightmap.lod <= 0.0 {
        return 0u;
    }
    let texels = clamp(s / heightmap.lod, 1.0, WALK_MIP_WIDEST);
    return min(firstLeadingBit(u32(texels)), heightmap.levels - 1u);
}

/// Marks the hit of a node by a ray that is `over` above its maximum: where the ray comes down to
/// the maximum, at most at `to`, or at once.
fn walk_mip_meet(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, node: MaximaNode, over: f32, to: f32) {
    var s = (*trace).s;
    if over > 0.0 && d.z < -GRID_FLAT {
        s = min(s + over / -d.z * WALK_TRUST_WAY, to);
        grid_land(o, d, trace, s);
        // The line by which the ray leaves the node belongs to the node.
        (*trace).cell = clamp((*trace).cell, node.low, node.high - 1);
    }
    grid_hit(trace, s);
}

/// One node or cell: its hit if the ray comes down to it, else the larger of its exit and the
/// cone's way.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let level = walk_mip_level((*trace).s);
    (*trace).level = level;
    let node = maxima_node((*trace).cell, level);
    let exit = grid_exit(o, d, node.low, node.high);
    let to = min(exit.x, (*trace).end);
    let z = o.z + (*trace).s * d.z;
    let over = z - maxima[node.at];
    if min(z, o.z + to * d.z) - maxima[node.at] <= 0.0 {
        if level > 0u {
            walk_mip_meet(o, d, trace, node, over, to);
            return STATE_HIT;
        }
        if grid_solve(o, d, trace, to) {
            return STATE_HIT;
        }
    }
    // Ratios are stored as the maxima are, and the maxima of cells are their apexes.
    var at = node.at;
    if !WALK_MIP_NODES {
        at = heightmap_number((*trace).cell);
    }
    let ratio = ratios[at] * WALK_TRUST_RATIO;
    let next = (*trace).s + cone_way(d, ratio, z - maxima[at], heightmap.offset) * WALK_TRUST_WAY;
    return grid_leave(o, d, trace, node.low, node.high, level, exit, next);
}
