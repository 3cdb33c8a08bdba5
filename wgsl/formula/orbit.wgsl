// What the orbit of a point tells about its distance to a Mandelbox that is not in Julia mode
// (docs/method.md, 3): an estimate for hits, and the radii of two balls for steps.

override ORBIT_ROTATED_SLOPE: f32;

/// Iterations in which the Jacobian is followed. They have loops of their own with a fixed number of
/// rounds, which drivers unroll. In one loop with the others, a device that runs both sides of every
/// branch would compute a Jacobian in every iteration.
const ORBIT_PREFIX = 3u;

/// Factors and radii stay below this, as products of two could overflow. The estimate is zero in
/// f32 before this limit.
const ORBIT_MOST = 1e15;

/// In f32 a ball spreads by so much more than its computed radius in one iteration.
const ORBIT_ROUND_UP = 1.000001;

/// How distances grow along an orbit. As long as all folds are linear, the Jacobian tells.
struct Growth {
    jacobian: Jacobian,
    /// Its norm.
    norm: real,
    /// The growth factor for all directions.
    scalar: real,
    /// The radius of a ball about the starting point in which the folds are linear.
    free: real,
    /// What later iterations do to a growth factor w: it becomes `product w + sum`.
    product: real,
    sum: real,
}

/// The sharp estimate, and the one with one growth factor for all directions.
struct Estimates {
    sharp: real,
    scalar: real,
}

fn growth_start() -> Growth {
    let one = real(1.0);
    return Growth(jacobian_start(), one, one, real(1e30), one, real(0.0));
}

/// Goes on by an iteration of any kind.
fn growth_goes_on(grown: ptr<function, Growth>, growth: real) {
    (*grown).product = min(growth * (*grown).product, real(ORBIT_MOST));
    (*grown).sum = min(growth * (*grown).sum + real(1.0), real(ORBIT_MOST));
}

/// Goes on by an iteration from z whose folds are linear.
fn growth_follows(grown: ptr<function, Growth>, z: real3, f: Fold) {
    let l = sqrt(f.square);
    let beyond = abs(z) - real3(real(folds.fold_limit));
    let sides = abs(beyond);
    let clearance = min(
        min(sides.x, min(sides.y, sides.z)),
        min(abs(l - real(folds.min_radius)), abs(l - real(folds.fixed_radius))),
    );
    (*grown).free = min((*grown).free, clearance / (*grown).norm);
    let mirror = select(real3(real(1.0)), real3(real(-1.0)), beyond > real3(real(0.0)));
    let scale = f.factor;
    (*grown).jacobian = jacobian_next((*grown).jacobian, mirror, scale);
    (*grown).norm = jacobian_norm((*grown).jacobian);
    (*grown).scalar = abs(scale) * (*grown).scalar + real(1.0);
}

/// Whether the factor of the ball fold varies about the point.
fn orbit_inverts(f: Fold) -> bool {
    return f.square > real(folds.min2) && f.square < real(folds.fixed2);
}

/// The estimates at the end of an orbit.
fn orbit_estimates(past: real, grown: Growth) -> Estimates {
    let tail = grown.sum + real(folds.tail);
    let scalar = past / (grown.product * grown.scalar + tail);
    if !FOLDS_FOLLOWED {
        return Estimates(scalar, scalar);
    }
    return Estimates(past / (grown.product * grown.norm + tail), scalar);
}

/// What a ball of a radius about a point spreads to in one iteration; `trial` is the radius that
/// it started with.
fn orbit_spread(f: Fold, radius: real, trial: real) -> real {
    let low = real(folds.min_radius);
    let high = real(folds.fixed_radius);
    let l = sqrt(f.square);
    let near = clamp(l - radius, low, high);
    let growth = abs(real(folds.scale)) * real(folds.fixed2) / (clamp(l, low, high) * near);
    return min((growth * radius + trial) * real(ORBIT_ROUND_UP), real(ORBIT_MOST));
}

/// The estimate, and the radius of a ball in which it should exceed `clear`.
fn estimate_step(p: real3, most: u32, clear: real) -> real2 {
    let exit = fold_exit(p);
    var z = p;
    var n = 0u;
    var grown = growth_start();
    // The growth factor with the norm after the first iteration, and the radius in which that is linear.
    var middle = real(1.0);
    var free = grown.free;
    var follows = true;
    for (var i = 0u; FOLDS_FOLLOWED && i < ORBIT_PREFIX; i++) {
        follows = follows && n < most && !fold_ended(z, exit);
        if follows {
            let f = fold(z);
            follows = !orbit_inverts(f);
            if follows {
                growth_follows(&grown, z, f);
                middle = select(abs(f.factor) * middle + real(1.0), grown.norm, i == 0u);
                free = select(free, grown.free, i == 0u);
                z = fold_next(f, p);
                n += 1u;
            }
        }
    }
    while n < most && !fold_ended(z, exit) {
        let f = fold(z);
        growth_goes_on(&grown, fold_growth(f));
        z = fold_next(f, p);
        n += 1u;
    }
    count_evaluation();
    count_iterations(n);
    let past = fold_top(z, p);
    let all = orbit_estimates(past, grown);
    let lipschitz = real(formula_lipschitz());
    let long = (all.sharp - clear) / lipschitz;
    let short = (all.scalar - clear) / lipschitz;
    var step = max(short, min(long, grown.free));
    if FOLDS_FOLLOWED {
        let between = past / (grown.product * middle + grown.sum + real(folds.tail));
        step = max(step, min((between - clear) / lipschitz, free));
    }
    return real2(all.sharp, step);
}

fn estimate(p: real3, most: u32) -> real {
    return estimate_step(p, most, real(0.0)).x;
}

/// A trial ball along an orbit.
struct Trial {
    /// The radius that it has spread to.
    radius: real,
    /// By so much the place where orbits escape differs within it.
    shift: real,
    /// The largest part of it that has escaped.
    share: real,
}

/// A radius that was cut off proves nothing.
fn trial_escapes(trial: ptr<function, Trial>, z: real3, p: real3) {
    if (*trial).radius < real(ORBIT_MOST) {
        let share = fold_top(z, p) / ((*trial).radius + (*trial).shift);
        (*trial).share = max((*trial).share, share);
    }
}

/// The estimate, and the radius of an empty ball, at most `trial`: the largest part of a trial
/// ball for which some iteration shows that all of it escapes.
fn estimate_ball(p: real3, most: u32, trial: real) -> real2 {
    let exit = fold_exit(p);
    var z = p;
    var n = 0u;
    var grown = growth_start();
    let shift = select(abs(real(folds.kappa)), real(folds.tail), ROTATES) * trial;
    var ball = Trial(trial, shift, fold_top(z, p) / (trial + shift));
    var follows = true;
    for (var i = 0u; i < ORBIT_PREFIX; i++) {
        if n < most && !fold_ended(z, exit) {
            let f = fold(z);
            follows = follows && !orbit_inverts(f);
            if follows {
                growth_follows(&grown, z, f);
            } else {
                growth_goes_on(&grown, fold_growth(f));
            }
            // As long as the trial ball meets no fold, its image is an ellipsoid.
            if follows && grown.free >= trial {
                ball.radius = grown.norm * trial * real(ORBIT_ROUND_UP);
            } else {
                ball.radius = orbit_spread(f, ball.radius, trial);
            }
            z = fold_next(f, p);
            n += 1u;
            trial_escapes(&ball, z, p);
        }
    }
    while n < most && !fold_ended(z, exit) {
        let f = fold(z);
        growth_goes_on(&grown, fold_growth(f));
        ball.radius = orbit_spread(f, ball.radius, trial);
        z = fold_next(f, p);
        n += 1u;
        trial_escapes(&ball, z, p);
    }
    count_evaluation();
    count_iterations(n);
    let all = orbit_estimates(fold_top(z, p), grown);
    return real2(all.sharp, trial * min(ball.share, real(1.0)));
}

/// The estimate, and the radius of a ball for cones, at most `trial`. With a rotation the proven
/// balls are so small that cones do not pay.
fn estimate_cone(p: real3, most: u32, trial: real) -> real2 {
    if ROTATES {
        let step = estimate_step(p, most, real(0.0));
        return real2(step.x, step.y / real(ORBIT_ROTATED_SLOPE));
    }
    return estimate_ball(p, most, trial);
}
