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

fn estimate_four(p: Points, most: u32) -> real4 {
    let limit = real4(real(folds.fold_limit));
    let low = real4(real(folds.min2));
    let high = real4(real(folds.fixed2));
    let scaled = real(folds.scale) * real(folds.fixed2);
    let one = real4(real(1.0));
    let large = real4(real(FOUR_MOST));
    var c = p;
    var gain = one;
    if FOLDS_JULIA {
        let own = real3(folds.julia);
        c = Points(real4(own.x), real4(own.y), real4(own.z));
        gain = real4(real(0.0));
    }
    let exit = four_exit(c);
    var z = p;
    var w = one;
    // The diagonal of the Jacobian, and where it is still followed.
    var j = Points(one, one, one);
    var follows = vec4<bool>(!FOLDS_JULIA && folds.followed == 1u);
    var iterations = vec4<u32>(0u);
    for (var n = 0u; n < most; n++) {
        let going = four_largest(z) <= exit;
        if !any(going) {
            break;
        }
        let b = Points(
            real(2.0) * clamp(z.x, -limit, limit) - z.x,
            real(2.0) * clamp(z.y, -limit, limit) - z.y,
            real(2.0) * clamp(z.z, -limit, limit) - z.z,
        );
        let square = b.x * b.x + b.y * b.y + b.z * b.z;
        let factor = scaled / clamp(square, low, high);
        var next = min(abs(factor) * w + gain, large);
        if n < FOUR_PREFIX {
            follows &= (square <= low) | (square >= high);
            j.x = select(factor, -factor, abs(z.x) > limit) * j.x + one;
            j.y = select(factor, -factor, abs(z.y) > limit) * j.y + one;
            j.z = select(factor, -factor, abs(z.z) > limit) * j.z + one;
            next = select(next, four_largest(j), follows);
        }
        w = select(w, next, going);
        z.x = select(z.x, factor * b.x + c.x, going);
        z.y = select(z.y, factor * b.y + c.y, going);
        z.z = select(z.z, factor * b.z + c.z, going);
        iterations += vec4<u32>(going);
    }
    for (var i = 0u; i < 4u; i++) {
        count_evaluation();
        count_iterations(iterations[i]);
    }
    let top = four_top(z, c);
    if FOLDS_JULIA {
        // Before an orbit has escaped for good, one large coordinate proves nothing.
        let k = real(folds.k_at_zero) + four_length(c) * real(folds.tail);
        return select(four_length(z) - k, top, four_largest(z) > exit) / w;
    }
    return top / (w + real(folds.tail));
}
