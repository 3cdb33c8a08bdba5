// What the orbit of a point tells about its distance to a Mandelbox that is not in Julia mode
// (docs/method.md, 3).
//
//     W(k) = w after the orbit, from the norm of the Jacobian after its first k iterations
//     estimate = top / (W(3) + tail)
//     chain = max over k of min(top / (W(k) + tail), the ball in which k iterations are linear)
//     ball = a part of a trial ball, followed through all iterations
//
// Callers read some of the results. Compilers drop what is not read.

override ORBIT_ROTATED_SLOPE: f32;

/// Iterations in which the Jacobian is followed.
const ORBIT_PREFIX = 3u;

/// Products stay below this, as their squares could overflow. The estimate is zero in f32 before
/// this limit.
const ORBIT_MOST = 1e15;

/// In f32 a ball spreads by so much more than its computed radius in one iteration.
const ORBIT_ROUND_UP = 1.000001;

struct Orbit {
    value: real,
    chain: real,
    ball: real,
}

/// What a trial ball about the point spreads to in one iteration.
fn orbit_spread(f: Fold, l: real, radius: real, trial: real) -> real {
    let low = real(folds.min_radius);
    let high = real(folds.fixed_radius);
    let near = clamp(l - radius, low, high);
    let growth = abs(real(folds.scale)) * real(folds.fixed2) / (clamp(l, low, high) * near);
    return min((growth * radius + trial) * real(ORBIT_ROUND_UP), real(ORBIT_MOST));
}

fn orbit_follow(p: real3, most: u32, clear: real, trial: real) -> Orbit {
    let exit = fold_exit(p);
    let limit = real(folds.fold_limit);
    let low = real(folds.min_radius);
    let high = real(folds.fixed_radius);
    let counts = vec4<u32>(0u, 1u, 2u, 3u);
    let shift = select(abs(real(folds.kappa)), real(folds.tail), ROTATES) * trial;
    var z = p;
    var n = 0u;
    var w = real4(real(1.0));
    var room = real4(real(1e30));
    var jacobian = jacobian_start();
    var norm = real(1.0);
    var free = real(1e30);
    var radius = trial;
    var share = fold_top(z, p) / (radius + shift);
    while n < min(most, ORBIT_PREFIX) && !fold_ended(z, exit) {
        let f = fold(z);
        if f.square > real(folds.min2) && f.square < real(folds.fixed2) {
            break;
        }
        let l = sqrt(f.square);
        let beyond = abs(z) - real3(limit);
        let sides = abs(beyond);
        let clearance = min(
            min(sides.x, min(sides.y, sides.z)),
            min(abs(l - low), abs(l - high)),
        );
        free = min(free, clearance / norm);
        let mirror = select(real3(real(1.0)), real3(real(-1.0)), beyond > real3(real(0.0)));
        let growth = fold_growth(f);
        jacobian = jacobian_next(jacobian, mirror, real(folds.scale) * real(folds.fixed2) * f.m);
        norm = jacobian_norm(jacobian);
        radius = select(orbit_spread(f, l, radius, trial), norm * trial, free >= trial);
        let followed = counts <= vec4<u32>(n);
        w = select(real4(norm), growth * w + real4(real(1.0)), followed);
        room = select(real4(free), room, followed);
        z = fold_next(f, p);
        n += 1u;
        share = max(share, fold_top(z, p) / (radius + shift));
    }
    var product = real(1.0);
    var sum = real(0.0);
    while n < most && !fold_ended(z, exit) {
        let f = fold(z);
        radius = orbit_spread(f, sqrt(f.square), radius, trial);
        let growth = fold_growth(f);
        product = min(growth * product, real(ORBIT_MOST));
        sum = min(growth * sum + real(1.0), real(ORBIT_MOST));
        z = fold_next(f, p);
        n += 1u;
        share = max(share, fold_top(z, p) / (radius + shift));
    }
    count_evaluation();
    count_iterations(n);
    let ends = product * w + real4(sum + real(folds.tail));
    let estimates = real4(fold_past(z, p, exit)) / ends;
    let ball = trial * min(share, real(1.0));
    let steps = (estimates - real4(clear)) / real(formula_lipschitz());
    if folds.followed == 0u {
        return Orbit(estimates.x, steps.x, ball);
    }
    let claims = min(steps, room);
    let chain = max(max(claims.x, claims.y), max(claims.z, claims.w));
    return Orbit(estimates.w, chain, ball);
}

fn estimate(p: real3, most: u32) -> real {
    return orbit_follow(p, most, real(0.0), real(1.0)).value;
}

/// The estimate, and the radius of a ball in which it should exceed `clear`.
fn estimate_step(p: real3, most: u32, clear: real) -> real2 {
    let all = orbit_follow(p, most, clear, real(1.0));
    return real2(all.value, all.chain);
}

/// The estimate, and the radius of a ball for cones, at most `trial`. With a rotation the proven
/// balls are so small that cones do not pay.
fn estimate_cone(p: real3, most: u32, trial: real) -> real2 {
    if ROTATES {
        let all = orbit_follow(p, most, real(0.0), real(1.0));
        return real2(all.value, all.chain / real(ORBIT_ROTATED_SLOPE));
    }
    return estimate_ball(p, most, trial);
}

/// The estimate, and the radius of an empty ball, at most `trial`. It is proven.
fn estimate_ball(p: real3, most: u32, trial: real) -> real2 {
    let all = orbit_follow(p, most, real(0.0), trial);
    return real2(all.value, all.ball);
}
