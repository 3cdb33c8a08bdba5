// Relief mapping: a number of equal steps over the part of the ray inside the block, then
// bisection (Policarpo, Oliveira, Comba 2005). The tracer misses what is thinner than a step.

/// Starts a ray with all of its steps.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    var trace = grid_begin(o, d, front, to);
    trace.left = heightmap.steps;
    return trace;
}

/// One step of those that are left.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let s = (*trace).s;
    let left = (*trace).left;
    // Only the first step can begin under the surface.
    if left == heightmap.steps {
        if refine_over(o, d, s) <= 0.0 {
            grid_hit(trace, s);
            return STATE_HIT;
        }
    }
    // The last step ends exactly where the ray does.
    var next = (*trace).end;
    if left > 1u {
        next = s + ((*trace).end - s) / f32(left);
    }
    // At the bottom the ray is under the surface by definition.
    if (left <= 1u && (*trace).falls == 1u) || refine_over(o, d, next) <= 0.0 {
        refine_binary(o, d, trace, vec2<f32>(s, next));
        return STATE_HIT;
    }
    if left <= 1u {
        return grid_end(trace);
    }
    (*trace).left = left - 1u;
    grid_land(o, d, trace, next);
    return STATE_MOVING;
}
