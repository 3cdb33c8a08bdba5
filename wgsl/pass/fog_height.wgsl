// How much fog there is along a ray, if it thins out with the height.

/// Below so many scale heights fog gets no denser. It is opaque long before.
const FOG_DEEPEST = -60.0;

/// The mean of `exp(-x)` from 0 to x: `(1 - exp(-x)) / x` without cancellation.
fn fog_mean(x: f32) -> f32 {
    if x > 0.5 {
        return (1.0 - exp(-x)) / x;
    }
    return 1.0 - x / 2.0
        * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0)))));
}

/// The optical depth of the first `t` units of a ray: the integral of the density, which is
/// `fog exp(-h)` at a height of h scale heights.
fn fog_depth(ray: Beam, t: f32) -> f32 {
    let start = look.fog_start + look.fog_rise * dot(ray.origin, look.world_up);
    let rise = look.fog_rise * dot(ray.axis, look.world_up) * t;
    let low = max(min(start, start + rise), FOG_DEEPEST);
    return look.fog * t * exp(-low) * fog_mean(abs(rise));
}
