// Glow: light that the air sends out near the surface, summed up along the ray of a pixel. At the
// distance d it is `exp(-d / width)` per width, and fog of the depth f lets `exp(-f)` through.

/// Length of a part next to the surface, in widths.
const GLOW_FINE = 0.25;
/// Parts of a ray at least, where there is glow.
const GLOW_LEAST = 32.0;
/// So many widths from the surface there is no glow.
const GLOW_NONE = 10.0;

/// The mean of `exp(-x)` from 0 to x.
fn glow_mean(x: f32) -> f32 {
    // The quotient would cancel.
    if x < 0.01 {
        return 1.0 - x * (0.5 - x / 6.0);
    }
    return (1.0 - exp(-x)) / x;
}

/// The distance of a point of a ray from the surface, in widths.
fn glow_away(ray: Beam, t: f32) -> f32 {
    return room(ray.origin + t * ray.axis, 1e30) * look_parameters.glow.rate;
}

/// Radiance of the glow on the first `end` units of a ray.
///
/// Within a part, distance and fog are taken to be linear, and so the integral is one of an
/// exponential. A part ends before the glow of what is ahead can begin.
fn glow(ray: Beam, end: f32) -> vec3<f32> {
    let own = look_parameters.glow;
    // A program may be kept when the number becomes zero.
    if all(own.light == vec3<f32>(0.0)) {
        return vec3<f32>(0.0);
    }
    let least = end / f32(own.parts);
    let most = end / GLOW_LEAST;
    var t = 0.0;
    var far = glow_away(ray, 0.0);
    // What dims the glow of a place: its distance and the fog before it.
    var dim = far;
    var sum = 0.0;
    for (var i = 0u; i < own.parts; i++) {
        let fine = min(GLOW_FINE * sqrt(1.0 + far) / own.rate, most);
        let part = max(fine, (far - GLOW_NONE) / own.rate);
        let next = min(t + max(part, least), end);
        far = glow_away(ray, next);
        let then = far + fog_depth(ray, next);
        sum += (next - t) * exp(-min(dim, then)) * glow_mean(abs(then - dim));
        t = next;
        dim = then;
        if t >= end {
            break;
        }
    }
    return own.light * (sum * own.rate);
}
