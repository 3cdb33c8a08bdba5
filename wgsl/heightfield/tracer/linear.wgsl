// Relief mapping: so many equal steps over the part of the ray inside the block, then
// halvings (Policarpo, Oliveira, Comba 2005). What is thinner than a step is missed.

/// Starts a ray with all of its steps.
fn trace_begin(o: vec3<f32>, d: vec3<f32>, front: f32, to: f32) -> Trace {
    var trace = course_begin(o, d, front, to);
    trace.left = relief.steps;
    return trace;
}

/// One of the steps that are left, all of one length.
fn trace_step(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>) -> u32 {
    if (*trace).state != STATE_MOVING {
        return (*trace).state;
    }
    count_evaluation();
    let s = (*trace).s;
    let left = (*trace).left;
    (*trace).gap = o.z + s * d.z - relief_apex((*trace).cell);
    // Only the first step can begin under the surface.
    if left == relief.steps {
        if refine_over(o, d, s) <= 0.0 {
            course_hit(o, d, trace, s);
            return STATE_HIT;
        }
    }
    // The last ends where the ray does, whatever rounding made of the others.
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
        return course_end(o, d, trace);
    }
    (*trace).left = left - 1u;
    course_land(o, d, trace, next);
    return STATE_MOVING;
}
