// From a place above the surface and a later one under it to the hit between them: by
// halvings, by false positions, or by settling, which halves until few cells are left and
// solves those exactly. All keep the bracket. Where there are several crossings, any may
// be found. Over boxes every bracket is settled after its rounds: a place near a box says
// nothing of whether its top is met or a side.

/// Halvings of a settling bracket, and cells that are solved then: what is left of 2^16
/// cells is a small part of one, which three share at most, around a corner.
const SETTLE_ROUNDS = 24u;
const SETTLE_CELLS = 4u;

/// Height of the ray above the surface at s, in whatever cell it is there.
fn refine_over(o: vec3<f32>, d: vec3<f32>, s: f32) -> f32 {
    let cell = course_cell(o, d, s);
    return o.z + s * d.z - relief_height(cell, course_uv(o, d, cell, s));
}

/// Marks a hit at s, whatever cell that is in.
fn refine_mark(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, s: f32) {
    (*trace).cell = course_cell(o, d, s);
    course_hit(o, d, trace, s);
}

/// Halvings, and the middle of what is left.
fn refine_binary(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, bracket: vec2<f32>) {
    var low = bracket.x;
    var high = bracket.y;
    for (var i = 0u; i < relief.rounds; i++) {
        count_iterations(1u);
        let middle = 0.5 * (low + high);
        if refine_over(o, d, middle) <= 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    if RELIEF_BOXES {
        refine_settle(o, d, trace, vec2<f32>(low, high));
        return;
    }
    refine_mark(o, d, trace, 0.5 * (low + high));
}

/// False positions: where the straight line between the heights at both ends crosses.
fn refine_secant(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, bracket: vec2<f32>) {
    var low = bracket.x;
    var high = bracket.y;
    var above = max(refine_over(o, d, low), 0.0);
    var under = min(refine_over(o, d, high), 0.0);
    var at = high;
    for (var i = 0u; i < relief.rounds; i++) {
        count_iterations(1u);
        let drop = above - under;
        // Both ends on the surface: the first is the hit.
        at = low;
        if drop > 0.0 {
            at = low + (high - low) * (above / drop);
        }
        let over = refine_over(o, d, at);
        if over <= 0.0 {
            high = at;
            under = over;
        } else {
            low = at;
            above = over;
        }
    }
    if RELIEF_BOXES {
        refine_settle(o, d, trace, vec2<f32>(low, high));
        return;
    }
    refine_mark(o, d, trace, at);
}

/// Halvings until both ends lie in one cell, or nearly, then the patches between them.
fn refine_settle(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, bracket: vec2<f32>) {
    var low = bracket.x;
    var high = bracket.y;
    for (var i = 0u; i < SETTLE_ROUNDS; i++) {
        if all(course_cell(o, d, low) == course_cell(o, d, high)) {
            break;
        }
        count_iterations(1u);
        let middle = 0.5 * (low + high);
        if refine_over(o, d, middle) <= 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    // The first of these patches that is met is the hit.
    course_land(o, d, trace, low);
    for (var i = 0u; i < SETTLE_CELLS; i++) {
        let exit = course_exit(o, d, (*trace).cell, (*trace).cell + 1);
        if course_solve(o, d, trace, min(exit.x, high)) {
            return;
        }
        if exit.x >= high {
            break;
        }
        course_cross(d, trace, exit);
    }
    // Under the surface by less than a rounding, or at the edge of a box.
    refine_mark(o, d, trace, high);
}
