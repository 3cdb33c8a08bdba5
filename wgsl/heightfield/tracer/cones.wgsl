// Cone stepping with one cone for each sample: the tracers of the papers, corrected (Dummer 2006;
// Policarpo and Oliveira 2007). A step goes as far as the cone, or to the cell's edge if that is
// farther. The first place under the surface ends the search, and the hit is refined between it
// and the place before. A ray that has used up its own steps has not converged. The cones keep
// clear of the samples, not of the surface between them: rays may pass thin parts of it.

/// Whether to take height and ratio of the nearest sample, instead of the surface's height and
/// the interpolated ratio.
override CONES_NEAREST: bool;
/// Whether every patch on the way is solved.
override CONES_SOLVE: bool;
/// Whether the number of steps follows the view.
override CONES_VIEW: bool;
/// Whether brackets are refined by secants instead of bisections, unless they are solved.
override CONES_SECANT: bool;

/// A sample's place in its tile, for indices from -1 to the size.
fn cones_place(at: vec2<i32>) -> i32 {
    let n = heightmap.samples;
    let wraps = heightmap.wrap == vec2<u32>(1u);
    let i = select(clamp(at, vec2<i32>(0), n - 1), (at + n) % n, wraps);
    return i.y * n.x + i.x;
}

/// Height and ratio of the cone over the ray at s, in a cell.
fn cones_at(o: vec3<f32>, d: vec3<f32>, cell: vec2<i32>, s: f32) -> vec2<f32> {
    let at = grid_uv(o, d, cell, s);
    let own = heightmap_tile_cell(cell);
    // The sample of a box lies in its middle, those of a patch in its corners.
    if CONES_NEAREST {
        let place = own + select(vec2<i32>(at + 0.5), vec2<i32>(0), HEIGHTMAP_BOXES);
        return vec2<f32>(heights_at(cones_place(place)), cones_ratio(d, place));
    }
    let middle = at - 0.5;
    let shift = select(vec2<f32>(0.0), floor(middle), HEIGHTMAP_BOXES);
    let f = select(at, middle - shift, HEIGHTMAP_BOXES);
    let i = own + vec2<i32>(shift);
    let a = cones_ratio(d, i);
    let b = cones_ratio(d, i + vec2<i32>(1, 0));
    let c = cones_ratio(d, i + vec2<i32>(0, 1));
    let e = cones_ratio(d, i + vec2<i32>(1, 1));
    let low = a + f.x * (b - a);
    let high = c + f.x * (e - c);
    return vec2<f32>(heightmap_height(cell, at), low + f.y * (high - low));
}

/// Steps of a ray that begins at s; 0 for no limit. If they follow the view, they are
/// steps * (0.5 + the horizontal part of the direction in texture widths and heights), fewer with
/// the distance.
fn cones_steps(d: vec3<f32>, s: f32) -> u32 {
    if !CONES_VIEW {
        return heightmap.steps;
    }
    let flat = d.xy / vec2<f32>(heightmap.cells);
    let whole = max(length(vec3<f32>(flat, d.z)), 1e-30);
    var far = 1.0;
    if heightmap.lod > 0.0 {
        far = 1.0 + max(s, 0.0) / heightmap.lod;
    }
    return u32(max(ceil(f32(heightmap.steps) * (0.5 + length(flat) / whole) / far), 1.0));
}

/// Starts a ray with the steps that its direction gives it.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    var trace = grid_begin(o, d, front, to);
    trace.left = cones_steps(d, trace.s);
    return trace;
}

/// One cone, and the height where it ends.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let cell = (*trace).cell;
    let s = (*trace).s;
    let end = (*trace).end;
    let exit = grid_exit(o, d, cell, cell + 1);
    let to = min(exit.x, end);
    let z = o.z + s * d.z;
    // Only the first step can begin under the surface.
    if refine_over(o, d, s) <= 0.0 {
        grid_hit(trace, s);
        return STATE_HIT;
    }
    if CONES_SOLVE && min(z, o.z + to * d.z) - heightmap_apex(cell) <= 0.0 {
        if grid_solve(o, d, trace, to) {
            return STATE_HIT;
        }
    }
    let cone = cones_at(o, d, cell, s);
    let way = cone_way(d, cone.y, z - cone.x, 0.0) * heightmap.scale;
    let next = min(max(s + way, exit.x), end);
    // At the bottom the ray is under the surface by definition.
    if (next >= end && (*trace).falls == 1u) || refine_over(o, d, next) <= 0.0 {
        if CONES_SOLVE {
            refine_patches(o, d, trace, vec2<f32>(to, next));
        } else if CONES_SECANT {
            refine_secant(o, d, trace, vec2<f32>(s, next));
        } else {
            refine_binary(o, d, trace, vec2<f32>(s, next));
        }
        return STATE_HIT;
    }
    let state = grid_leave(o, d, trace, cell, cell + 1, 0u, exit, next);
    // The ray is above the surface after the last of its own steps: it has not converged.
    if state == STATE_MOVING && (*trace).left == 1u {
        (*trace).state = STATE_UNCONVERGED;
    }
    (*trace).left = max((*trace).left, 1u) - 1u;
    return (*trace).state;
}
