// A scene given by a distance estimate: cones by the exact step, rays by sphere
// tracing with relaxation (METHOD 2). Positions come relative to the eye.

struct DistanceUniform {
    eye: vec3<f32>,
    /// Hit where estimate <= detail * footprint.
    detail: f32,
    /// The bounds: a box about a centre, cut by a ball about the same centre.
    centre: vec3<f32>,
    radius: f32,
    half: vec3<f32>,
    /// Nothing is farther from the eye than this.
    far: f32,
    /// Steps divide by this: the estimate's largest slope.
    lipschitz: f32,
    /// A step keeps clear of `shell * eps` of the surface.
    shell: f32,
    /// Of rays: 0 automatic, 1 off, else a fixed factor.
    relaxation: f32,
    /// Factor on every ray step; 1 but for the truth.
    stride: f32,
    iterations: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

/// A ray on its way: the last accepted point, the ball proven empty about it, the
/// length of the next step, the smoothed slope of the radius, and the end.
struct Walk {
    t: f32,
    radius: f32,
    pace: f32,
    slope: f32,
    end: f32,
}

override DISTANCE_ENOUGH: f32;
override DISTANCE_SMOOTHING: f32;
override DISTANCE_MOST_RELAXED: f32;
override HIT_CARRIES_MARK: bool;

@group(0) @binding(0) var<uniform> distance_scene: DistanceUniform;

fn estimate_at(q: vec3<f32>) -> f32 {
    return f32(estimate(real3(distance_scene.eye) + real3(q), distance_scene.iterations));
}

/// Distance to the bounds, 0 inside.
fn bounds_distance(q: vec3<f32>) -> f32 {
    let p = (distance_scene.eye - distance_scene.centre) + q;
    let o = max(abs(p) - distance_scene.half, vec3<f32>(0.0));
    return max(length(o), max(0.0, length(p) - distance_scene.radius));
}

/// The distance past which there is nothing.
fn bounds_far() -> f32 {
    return distance_scene.far;
}

/// The part of a ray inside the bounds as (near, far); near > far if it misses.
fn bounds_interval(ray: Beam) -> vec2<f32> {
    let p = (distance_scene.eye - distance_scene.centre) + ray.origin;
    // A vanishing component divides to a huge number, never to an infinity.
    let tiny = select(vec3<f32>(-1e-18), vec3<f32>(1e-18), ray.axis >= vec3<f32>(0.0));
    let a = select(ray.axis, tiny, abs(ray.axis) < vec3<f32>(1e-18));
    // Widened by the rounding of p and of the quotient.
    let room = distance_scene.half + 1e-6 * (abs(p) + distance_scene.half);
    let one = (-room - p) / a;
    let two = (room - p) / a;
    let low = min(one, two);
    let high = max(one, two);
    var near = max(low.x, max(low.y, low.z));
    var far = min(high.x, min(high.y, high.z));
    let b = dot(p, ray.axis);
    let r = distance_scene.radius * (1.0 + 1e-6);
    // Squared distance of the ray's line from the centre, without b^2 - |p|^2.
    let off = p - b * ray.axis;
    let q = r * r - dot(off, off);
    if q < 0.0 {
        return vec2<f32>(1.0, -1.0);
    }
    near = max(near, -b - sqrt(q) * (1.0 + 1e-6));
    far = min(far, -b + sqrt(q) * (1.0 + 1e-6));
    return vec2<f32>(near, far);
}

/// The new proven front of a cone, or the old one where no more can be proven.
fn advance(cone: Beam, front: f32) -> f32 {
    let q = cone.origin + front * cone.axis;
    let eps = distance_scene.detail * footprint(cone, front);
    var d = bounds_distance(q) - cone.r0;
    // Outside the bounds their distance will do, while it carries the cone.
    if d <= 2.0 * cone.k * front {
        let e = (estimate_at(q) - distance_scene.shell * eps) / distance_scene.lipschitz;
        d = max(d, e - cone.r0);
    }
    let next = cone_front(front, front, d, cone.k);
    // A short gain is better left to the four thinner children.
    if next - front < DISTANCE_ENOUGH * d {
        return front;
    }
    return next;
}

fn begin(ray: Beam, front: f32, t_max: f32) -> Walk {
    let span = bounds_interval(ray);
    return Walk(max(front, span.x), 0.0, 0.0, -1.0, min(span.y, t_max));
}

/// One step along a ray: STATE_MOVING, STATE_HIT, or STATE_SKY when past the end.
///
/// The next sample lies `pace` ahead. If the ball there and the last one leave a gap
/// between them, nothing is accepted and the next sample is taken at the ball's edge
/// (Keinert et al. 2014). The automatic pace extrapolates the radius linearly, so
/// that the two balls just touch (Ban and Valasek 2023).
fn walk_step(ray: Beam, walk: ptr<function, Walk>) -> u32 {
    let w = *walk;
    if w.t + w.radius > w.end {
        return STATE_SKY;
    }
    let t = min(w.t + w.pace, w.end);
    let gone = t - w.t;
    let raw = estimate_at(ray.origin + t * ray.axis);
    let eps = distance_scene.detail * footprint(ray, t);
    let radius = (raw - distance_scene.shell * eps) * (distance_scene.stride / distance_scene.lipschitz);
    if gone > w.radius && gone > w.radius + max(radius, 0.0) {
        (*walk).pace = w.radius;
        (*walk).slope = -1.0;
        return STATE_MOVING;
    }
    (*walk).t = t;
    if raw <= eps {
        return STATE_HIT;
    }
    var slope = w.slope;
    var factor = distance_scene.relaxation;
    if factor == 0.0 {
        if gone > 0.0 && w.radius > 0.0 {
            slope = mix(slope, (radius - w.radius) / gone, DISTANCE_SMOOTHING);
        }
        factor = clamp(2.0 / max(1.0 - slope, 1e-3), 1.0, DISTANCE_MOST_RELAXED);
    }
    (*walk).radius = radius;
    (*walk).slope = slope;
    (*walk).pace = radius * factor;
    return STATE_MOVING;
}

/// What the walk has found.
fn walk_hit(walk: Walk) -> Hit {
    return Hit(walk.t, 0u, vec2<f32>(0.0));
}

/// Radius of a surely empty ball about a point.
fn clearance(q: vec3<f32>) -> f32 {
    return max(bounds_distance(q), max(0.0, estimate_at(q)) / distance_scene.lipschitz);
}

/// Normal by the estimate's gradient over the corners of a tetrahedron half a pixel
/// wide; pigment from the orbit.
fn surface(ray: Beam, hit: Hit) -> Surface {
    let q = ray.origin + hit.t * ray.axis;
    let h = 0.5 * footprint(ray, hit.t) + distance_scene.far * 1e-7;
    let a = vec3<f32>(1.0, -1.0, -1.0);
    let b = vec3<f32>(-1.0, -1.0, 1.0);
    let c = vec3<f32>(-1.0, 1.0, -1.0);
    let d = vec3<f32>(1.0, 1.0, 1.0);
    let g = a * estimate_at(q + h * a) + b * estimate_at(q + h * b)
        + c * estimate_at(q + h * c) + d * estimate_at(q + h * d);
    let n = length(g);
    // A flat estimate has no gradient: turn such a point to the viewer.
    var normal = -ray.axis;
    if n > 1e-20 {
        normal = g / n;
    }
    let pigment = trap(real3(distance_scene.eye) + real3(q), distance_scene.iterations);
    return Surface(normal, pigment);
}
