// The estimates of `orbit.wgsl` and `julia.wgsl` at four points, without a rotation. Four orbits
// run side by side. Each operation of an orbit waits for the one before, and those of the others
// fill the time.

/// Growth factors stay below this, as products of two could overflow. The estimate is zero in f32
/// before this limit.
const FOUR_MOST = 1e15;

/// Iterations in which the Jacobian is followed: see `orbit.wgsl`.
const FOUR_PREFIX = 3u;

fn four_largest(p: Points) -> real4 {
    return max(abs(p.x), max(abs(p.y), abs(p.z)));
}

fn four_length(p: Points) -> real4 {
    return sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
}

/// The coordinates at which four orbits end: see `fold_exit`.
fn four_exit(c: Points) -> real4 {
    let shift = abs(real(folds.kappa)) * four_largest(c);
    let lead = real(folds.lead) + shift;
    let unfolded = real(folds.fixed_radius) - real(2.0 * folds.fold_limit) * real(folds.tail) + shift;
    let clear = max(real4(real(4.0 * folds.fold_limit)), real(0.05) * lead);
    return lead + max(clear, unfolded);
}

/// How far four points are past where points escape; 0 before: see `fold_top`.
fn four_top(z: Points, c: Points) -> real4 {
    let kappa = real(folds.kappa);
    let lead = real(folds.lead);
    let none = real4(real(0.0));
    return four_length(Points(
        max(abs(z.x - kappa * c.x) - lead, none),
        max(abs(z.y - kappa * c.y) - lead, none),
        max(abs(z.z - kappa * c.z) - lead, none),
    ));
}

/// Four orbits under way, and how distances grow along them.
struct Orbits {
    z: Points,
    growth: real4,
    /// The diagonal of the Jacobian, and where it is still followed.
    jacobian: Points,
    follows: vec4<bool>,
    iterations: vec4<u32>,
}

/// The next iteration of those orbits that still go on; `first` for those of the prefix.
fn four_fold(o: ptr<function, Orbits>, c: Points, going: vec4<bool>, first: bool) {
    let limit = real4(real(folds.fold_limit));
    let low = real4(real(folds.min2));
    let high = real4(real(folds.fixed2));
    let one = real4(real(1.0));
    let gain = select(one, real4(real(0.0)), FOLDS_JULIA);
    let z = (*o).z;
    let b = Points(
        real(2.0) * clamp(z.x, -limit, limit) - z.x,
        real(2.0) * clamp(z.y, -limit, limit) - z.y,
        real(2.0) * clamp(z.z, -limit, limit) - z.z,
    );
    let square = b.x * b.x + b.y * b.y + b.z * b.z;
    let factor = real(folds.scale) * real(folds.fixed2) / clamp(square, low, high);
    var growth = min(abs(factor) * (*o).growth + gain, real4(real(FOUR_MOST)));
    if first {
        (*o).follows &= (square <= low) | (square >= high);
        let j = (*o).jacobian;
        (*o).jacobian = Points(
            select(factor, -factor, abs(z.x) > limit) * j.x + one,
            select(factor, -factor, abs(z.y) > limit) * j.y + one,
            select(factor, -factor, abs(z.z) > limit) * j.z + one,
        );
        growth = select(growth, four_largest((*o).jacobian), (*o).follows);
    }
    (*o).growth = select((*o).growth, growth, going);
    (*o).z = Points(
        select(z.x, factor * b.x + c.x, going),
        select(z.y, factor * b.y + c.y, going),
        select(z.z, factor * b.z + c.z, going),
    );
    (*o).iterations += vec4<u32>(going);
}

fn estimate_four(p: Points, most: u32) -> real4 {
    var c = p;
    if FOLDS_JULIA {
        let own = real3(folds.julia);
        c = Points(real4(own.x), real4(own.y), real4(own.z));
    }
    let exit = four_exit(c);
    let one = real4(real(1.0));
    var o = Orbits(p, one, Points(one, one, one), vec4<bool>(true), vec4<u32>(0u));
    var n = 0u;
    // A loop of its own: see `orbit.wgsl`.
    if FOLDS_FOLLOWED && !FOLDS_JULIA {
        for (; n < FOUR_PREFIX; n++) {
            four_fold(&o, c, (four_largest(o.z) <= exit) & vec4<bool>(n < most), true);
        }
    }
    for (; n < most; n++) {
        let going = four_largest(o.z) <= exit;
        if !any(going) {
            break;
        }
        four_fold(&o, c, going, false);
    }
    for (var i = 0u; i < 4u; i++) {
        count_evaluation();
        count_iterations(o.iterations[i]);
    }
    let top = four_top(o.z, c);
    if FOLDS_JULIA {
        // Before an orbit has escaped for good, one large coordinate proves nothing.
        let k = real(folds.k_at_zero) + four_length(c) * real(folds.tail);
        return select(four_length(o.z) - k, top, four_largest(o.z) > exit) / o.growth;
    }
    return top / (o.growth + real(folds.tail));
}
