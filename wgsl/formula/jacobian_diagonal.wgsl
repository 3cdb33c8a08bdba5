// The derivative of a point of the orbit by the starting point, while all folds are linear.
// Without a rotation it is diagonal.

alias Jacobian = real3;

fn jacobian_start() -> Jacobian {
    return real3(real(1.0));
}

/// After a fold, a scale and the addition of the starting point. `mirror` is -1 for coordinates
/// that the fold mirrors, else 1.
fn jacobian_next(j: Jacobian, mirror: real3, scale: real) -> Jacobian {
    return scale * mirror * j + real3(real(1.0));
}

/// The operator norm.
fn jacobian_norm(j: Jacobian) -> real {
    let a = abs(j);
    return max(a.x, max(a.y, a.z));
}
