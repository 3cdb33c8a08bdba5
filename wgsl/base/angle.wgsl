// Cosine and sine of an angle from -pi to pi, to 2e-7. Those of WGSL may be off by 5e-4.

/// Both for the square of half the angle: the cosine, and the sine divided by the angle. They are
/// smooth there, and sums of a few terms.
fn angle_parts(half_squared: f32) -> vec2<f32> {
    let s = half_squared;
    // Taylor series of cos(h) and sin(h) / h. At h = pi / 2 the next term is below 1e-8.
    let c = 1.0 + s * (-0.5 + s * (4.1666667e-2 + s * (-1.3888889e-3
        + s * (2.4801587e-5 + s * (-2.7557319e-7 + s * 2.0876757e-9)))));
    let q = 1.0 + s * (-1.6666667e-1 + s * (8.3333333e-3 + s * (-1.9841270e-4
        + s * (2.7557319e-6 + s * (-2.5052108e-8 + s * 1.6059044e-10)))));
    return vec2<f32>(1.0 - 2.0 * s * q * q, q * c);
}

/// Cosine and sine.
fn angle_turn(a: f32) -> vec2<f32> {
    let parts = angle_parts(0.25 * a * a);
    return vec2<f32>(parts.x, a * parts.y);
}
