// Steps of a formula that has nothing but its estimate: it is divided by the Lipschitz constant.

/// The estimate, and the radius of a ball in which it should exceed `clear`.
fn estimate_step(p: real3, most: u32, clear: real) -> real2 {
    let value = estimate(p, most);
    return real2(value, (value - clear) / real(formula_lipschitz()));
}

/// The estimate, and the radius of an empty ball.
fn estimate_ball(p: real3, most: u32, trial: real) -> real2 {
    return estimate_step(p, most, real(0.0));
}

/// The same for cones.
fn estimate_cone(p: real3, most: u32, trial: real) -> real2 {
    return estimate_ball(p, most, trial);
}
