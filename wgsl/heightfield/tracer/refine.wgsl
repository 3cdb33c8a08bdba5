// Refinement: from a point above the surface and a later point under it, a bracket, to a hit
// between them. Bisection and the secant method end near the surface after some rounds. The
// refinement `Patches` bisects until few cells are left, and solves these exactly. If there are several
// crossings, any of them may be found. Over boxes every bracket ends so: a point near a box does not
// tell whether the ray meets its top or its side.

/// Bisections of a bracket over patches or boxes, and cells that are solved then. What is left of 2^16
/// cells is a small part of one, which lies in at most three cells, around a corner.
const BISECTIONS = 24u;
const SOLVED_CELLS = 4u;

/// The ray's height above the surface at s.
fn refine_over(o: vec3<f32>, d: vec3<f32>, s: f32) -> f32 {
    let cell = grid_cell(o, d, s);
    return o.z + s * d.z - heightmap_height(cell, grid_uv(o, d, cell, s));
}

/// Marks a hit at s, in the cell there.
fn refine_mark(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, s: f32) {
    (*trace).cell = grid_cell(o, d, s);
    grid_hit(trace, s);
}

/// Bisections; the hit is the middle of the bracket that is left.
fn refine_binary(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, bracket: vec2<f32>) {
    var low = bracket.x;
    var high = bracket.y;
    for (var i = 0u; i < heightmap.rounds; i++) {
        count_iterations(1u);
        let middle = 0.5 * (low + high);
        if refine_over(o, d, middle) <= 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    if HEIGHTMAP_BOXES {
        refine_patches(o, d, trace, vec2<f32>(low, high));
        return;
    }
    refine_mark(o, d, trace, 0.5 * (low + high));
}

/// Secants (regula falsi): the hit is where the line between the heights at both ends crosses.
fn refine_secant(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, bracket: vec2<f32>) {
    var low = bracket.x;
    var high = bracket.y;
    var above = max(refine_over(o, d, low), 0.0);
    var under = min(refine_over(o, d, high), 0.0);
    var at = high;
    for (var i = 0u; i < heightmap.rounds; i++) {
        count_iterations(1u);
        let drop = above - under;
        // With both ends on the surface the first is the hit.
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
    if HEIGHTMAP_BOXES {
        refine_patches(o, d, trace, vec2<f32>(low, high));
        return;
    }
    refine_mark(o, d, trace, at);
}

/// Bisections until both ends lie in one cell, or nearly, then the patches between them.
fn refine_patches(o: vec3<f32>, d: vec3<f32>, trace: ptr<function, Trace>, bracket: vec2<f32>) {
    var low = bracket.x;
    var high = bracket.y;
    for (var i = 0u; i < BISECTIONS; i++) {
        if all(grid_cell(o, d, low) == grid_cell(o, d, high)) {
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
    grid_land(o, d, trace, low);
    for (var i = 0u; i < SOLVED_CELLS; i++) {
        let exit = grid_exit(o, d, (*trace).cell, (*trace).cell + 1);
        if grid_solve(o, d, trace, min(exit.x, high)) {
            return;
        }
        if exit.x >= high {
            break;
        }
        grid_cross(d, trace, exit);
    }
    // The ray is under the surface by less than a rounding, or at the edge of a box.
    refine_mark(o, d, trace, high);
}
