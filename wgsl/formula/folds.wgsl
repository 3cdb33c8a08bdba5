// One iteration of the Mandelbox (docs/method.md, 3): box fold, ball fold, rotation, scale,
// translation.
//
//     b = 2 clamp(z, -L, L) - z;   m = f2 / clamp(|b|^2, r2, f2);   z' = s m R b + c
//
// In Julia mode c is a constant. `trap` follows the orbit again, for the colour of a hit.

struct FoldsUniform {
    julia: vec3<f32>,
    scale: f32,
    fold_limit: f32,
    /// The two radii of the ball fold, and their squares.
    min_radius: f32,
    fixed_radius: f32,
    min2: f32,
    fixed2: f32,
    /// The squared length at which an orbit ends if its coordinates do not tell.
    bail2: f32,
    /// Divisor of the estimate in the steps of rays.
    lipschitz: f32,
    /// 2 L |s| / (|s| - 1), 1 / (s + 1) and 1 / (|s| - 1).
    lead: f32,
    kappa: f32,
    tail: f32,
    /// K for c = 0, which is 2 sqrt(3) L |s| / (|s| - 1).
    k_at_zero: f32,
    /// |s - 1| and |s|^(1 - iterations), of the classic estimate.
    classic_offset: f32,
    classic_skin: f32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

override FOLDS_JULIA: bool;
/// Whether the Jacobian is followed. At negative scales it has next to no slack.
override FOLDS_FOLLOWED: bool;

@group(0) @binding(1) var<storage, read> folds_parameters: FoldsUniform;
var<private> folds: FoldsUniform;

/// A point after the box fold, its squared length, and the factor of the ball fold and the scale.
struct Fold {
    b: real3,
    square: real,
    factor: real,
}

fn formula_load() {
    folds = folds_parameters;
    rotation_load();
}

/// The Lipschitz constant: a bound of the estimate's slope.
fn formula_lipschitz() -> f32 {
    return folds.lipschitz;
}

/// What an iteration adds.
fn fold_constant(p: real3) -> real3 {
    if FOLDS_JULIA {
        return real3(folds.julia);
    }
    return p;
}

fn fold(z: real3) -> Fold {
    let limit = real(folds.fold_limit);
    let b = real(2.0) * clamp(z, real3(-limit), real3(limit)) - z;
    let square = dot(b, b);
    let scaled = real(folds.scale) * real(folds.fixed2);
    return Fold(b, square, scaled / clamp(square, real(folds.min2), real(folds.fixed2)));
}

fn fold_next(f: Fold, c: real3) -> real3 {
    return f.factor * rotate(f.b) + c;
}

/// By how much lengths grow.
fn fold_growth(f: Fold) -> real {
    return abs(f.factor);
}

fn fold_k(c: real3) -> real {
    return real(folds.k_at_zero) + length(c) * real(folds.tail);
}

/// Where a coordinate escapes, and past which no ball fold inverts again.
fn fold_edges(c: real3) -> real2 {
    let a = abs(c);
    let shift = abs(real(folds.kappa)) * max(a.x, max(a.y, a.z));
    let lead = real(folds.lead) + shift;
    let high = real(folds.fixed_radius);
    let unfolded = high - real(2.0 * folds.fold_limit) * real(folds.tail) + shift;
    return real2(lead, lead + max(unfolded, real(0.0)));
}

/// The coordinate at which orbits end.
fn fold_exit(c: real3) -> real {
    let edges = fold_edges(c);
    return max(edges.x + max(real(4.0 * folds.fold_limit), real(0.05) * edges.x), edges.y);
}

/// Whether an orbit has escaped for good.
fn fold_ended(z: real3, exit: real) -> bool {
    if ROTATES {
        return dot(z, z) > real(folds.bail2);
    }
    let a = abs(z);
    return max(a.x, max(a.y, a.z)) > exit;
}

/// How far a point is past where points escape; 0 before.
fn fold_top(z: real3, c: real3) -> real {
    if ROTATES {
        return max(length(z) - fold_k(c), real(0.0));
    }
    let off = abs(z - real(folds.kappa) * c) - real3(real(folds.lead));
    return length(max(off, real3(real(0.0))));
}

/// Three orbit traps from 0 to 1: how near the orbit comes to the origin, to the coordinate
/// planes and to the fixed sphere.
fn trap(p: real3, most: u32) -> vec3<f32> {
    let low = real(folds.min2);
    let high = real(folds.fixed2);
    let c = fold_constant(p);
    var z = p;
    var origin = real(1e10);
    var plane = real(1e10);
    var sphere = real(1e10);
    var n = 0u;
    // Later iterations only add noise to the colour.
    let last = min(most, 10u);
    while n < last && dot(z, z) <= real(folds.bail2) {
        let f = fold(z);
        let a = abs(f.b);
        origin = min(origin, f.square);
        plane = min(plane, min(a.x, min(a.y, a.z)));
        sphere = min(sphere, abs(f.square - high));
        z = (real(folds.scale) * high / clamp(f.square, low, high)) * rotate(f.b) + c;
        n += 1u;
    }
    let size = real(folds.fold_limit);
    return vec3<f32>(
        f32(sqrt(origin) / (sqrt(origin) + size)),
        f32(plane / (plane + real(0.25) * size)),
        f32(sphere / (sphere + high)),
    );
}
