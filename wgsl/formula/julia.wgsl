// The Mandelbox in Julia mode: every iteration adds the same constant (docs/method.md, 3).
//
//     estimate = top / w;   1 / radius = bend + w / outside
//
// `outside` is how far the end of the orbit is from all bounded orbits. `bend` is what ball folds
// take from the radius of a ball that is pulled back to the start.

/// w stays below this, as its product with the next factor could overflow. The estimate is
/// zero in f32 before this limit.
const JULIA_MOST_W = 1e30;

fn julia_follow(p: real3, most: u32, trial: real) -> real2 {
    let c = real3(folds.julia);
    let exit = fold_exit(c);
    var z = p;
    var w = real(1.0);
    var bend = real(0.0);
    let high = real(folds.fixed_radius);
    var n = 0u;
    while n < most && !fold_ended(z, exit) {
        let f = fold(z);
        let l = sqrt(f.square);
        // Outside the fixed sphere, the fold bends only what the trial ball has inside. 1/inverse is
        // the radius of the trial ball here, which the fold spreads to 1/spread at most.
        let inverse = max((real(1.0) / trial - bend) / w, real(0.0));
        let spread = max(l * inverse - real(1.0), real(0.0)) / high;
        let inside = real(1.0) - max(l - high, real(0.0)) * spread;
        if f.square >= real(folds.min2) {
            bend += w * max(inside, real(0.0)) / l;
        }
        w = min(fold_growth(f) * w, real(JULIA_MOST_W));
        z = fold_next(f, c);
        n += 1u;
    }
    count_evaluation();
    count_iterations(n);
    // Before an orbit has escaped for good, one large coordinate proves nothing.
    var top = length(z) - fold_k(c);
    if fold_ended(z, exit) {
        top = fold_top(z, c);
    }
    var outside = max(length(z) - fold_k(c), real(0.0));
    if !ROTATES {
        let half = real3(real(folds.lead)) + real(folds.tail) * abs(c);
        outside = max(
            length(max(abs(z) - half, real3(real(0.0)))),
            max(abs(z.x), max(abs(z.y), abs(z.z))) - fold_edges(c).y,
        );
    }
    return real2(top / w, min(trial, outside / (bend * outside + w)));
}

fn estimate(p: real3, most: u32) -> real {
    return julia_follow(p, most, real(1.0)).x;
}

/// The estimate, and the radius of a ball in which it should exceed `clear`.
fn estimate_step(p: real3, most: u32, clear: real) -> real2 {
    let value = estimate(p, most);
    return real2(value, (value - clear) / real(formula_lipschitz()));
}

/// The estimate, and the radius of a ball that is proven empty, at most `trial`.
fn estimate_ball(p: real3, most: u32, trial: real) -> real2 {
    return julia_follow(p, most, trial);
}

/// The same for cones.
fn estimate_cone(p: real3, most: u32, trial: real) -> real2 {
    return estimate_ball(p, most, trial);
}
