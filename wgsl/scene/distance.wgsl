// A scene given by a distance estimate. Cones advance by the cone step, rays by sphere tracing
// with relaxation (docs/method.md, 2). Positions are relative to the eye.
//
// Steps, hits and normals all use one field: the larger of the estimate and the distance to the
// bounds. So the bounds do not cut the visible surface open.

struct DistanceUniform {
    eye: vec3<f32>,
    /// Hit where estimate <= detail * footprint.
    detail: f32,
    /// The bounds: a box cut by a ball about the same centre.
    centre: vec3<f32>,
    radius: f32,
    half: vec3<f32>,
    /// Nothing is farther from the eye than this.
    far: f32,
    /// Steps keep clear of `shell * eps`, where eps is the hit threshold.
    shell: f32,
    /// How rays stretch their steps: 0 automatic, 1 off, else a factor.
    relaxation: f32,
    /// Factor on ray steps; less than 1 for the truth.
    stride: f32,
    iterations: u32,
    /// 1 to start rays where they enter the bounds, 0 at their front.
    clip: u32,
    /// The first ball that cones from the eye try.
    first_trial: f32,
    pad0: u32,
    pad1: u32,
}

/// The state of a ray between two steps: the last accepted point, the radius of the empty ball
/// there, the length of the next step, the smoothed slope of the radius, the value of the field,
/// and the end.
struct Walk {
    t: f32,
    radius: f32,
    pace: f32,
    slope: f32,
    room: f32,
    end: f32,
}

override DISTANCE_ENOUGH: f32;
override DISTANCE_TRIAL: f32;
override DISTANCE_LEAST: f32;
override DISTANCE_PROVEN: bool;
override DISTANCE_SMOOTHING: f32;
override DISTANCE_MOST_RELAXED: f32;
override DISTANCE_WITHIN: f32;
override HIT_CARRIES_MARK: bool;

@group(0) @binding(0) var<storage, read> distance_parameters: DistanceUniform;
var<private> distance_scene: DistanceUniform;

fn scene_load() {
    distance_scene = distance_parameters;
    formula_load();
}

fn scene_point(q: vec3<f32>) -> real3 {
    return real3(distance_scene.eye) + real3(q);
}

/// Distance to the bounds; 0 inside.
fn bounds_distance(q: vec3<f32>) -> f32 {
    let p = (distance_scene.eye - distance_scene.centre) + q;
    let o = max(abs(p) - distance_scene.half, vec3<f32>(0.0));
    return max(length(o), max(0.0, length(p) - distance_scene.radius));
}

/// The value of the field, given the estimate. Inside the bounds it may be negative: the gradient
/// needs it.
fn widened(inside: f32, outside: f32) -> f32 {
    return select(inside, max(inside, outside), outside > 0.0);
}

/// The value of the field.
fn field_value(q: vec3<f32>) -> f32 {
    let inside = f32(estimate(scene_point(q), distance_scene.iterations));
    return widened(inside, bounds_distance(q));
}

/// The values of the field at four points, given relative to q.
fn field_values(q: vec3<f32>, x: vec4<f32>, y: vec4<f32>, z: vec4<f32>) -> vec4<f32> {
    let p = scene_point(q);
    let at = Points(p.x + real4(x), p.y + real4(y), p.z + real4(z));
    let inside = vec4<f32>(estimate_four(at, distance_scene.iterations));
    return vec4<f32>(
        widened(inside.x, bounds_distance(q + vec3<f32>(x.x, y.x, z.x))),
        widened(inside.y, bounds_distance(q + vec3<f32>(x.y, y.y, z.y))),
        widened(inside.z, bounds_distance(q + vec3<f32>(x.z, y.z, z.z))),
        widened(inside.w, bounds_distance(q + vec3<f32>(x.w, y.w, z.w))),
    );
}

/// The value of the field, and the radius of a ball in which it should exceed `clear`. Where rays
/// go by proven balls, the ball is empty, but at most `trial` is tried.
fn field(q: vec3<f32>, clear: f32, trial: f32) -> vec2<f32> {
    let outside = bounds_distance(q);
    let p = scene_point(q);
    let most = distance_scene.iterations;
    var value = 0.0;
    var ball = outside - clear;
    if DISTANCE_PROVEN {
        let reading = estimate_ball(p, most, real(trial));
        value = f32(reading.x);
        ball = max(ball, f32(reading.y) - clear);
    } else {
        let reading = estimate_step(p, most, real(clear));
        value = f32(reading.x);
        ball = max(ball, f32(reading.y));
    }
    return vec2<f32>(widened(value, outside), ball);
}

/// The distance from the eye beyond which there is nothing.
fn bounds_far() -> f32 {
    return distance_scene.far;
}

/// The part of a ray, as (near, far), that is nearer to the bounds than DISTANCE_WITHIN hit
/// thresholds; near > far for none. The threshold grows along the ray, so the faces of the box
/// lean outwards.
fn bounds_interval(ray: Beam) -> vec2<f32> {
    let p = (distance_scene.eye - distance_scene.centre) + ray.origin;
    let within = DISTANCE_WITHIN * distance_scene.detail;
    let room = distance_scene.half + within * ray.grain0;
    // More than the rounding of p and of the quotients. The near faces move inwards by it, so
    // that no ray starts before it reaches the threshold. They move by at most a part of the
    // threshold, or hits very near the eye would be in front of them. The far faces move
    // outwards.
    let slack = 5e-7 * (abs(p) + distance_scene.half);
    let clear = max(abs(p) - distance_scene.half, vec3<f32>(0.0));
    let back = min(slack, 0.25 * within * (ray.grain0 + ray.grain * clear));
    let lean = within * ray.grain;
    // A ray no steeper than the lean may never cross a face. Its quotients are replaced by
    // huge numbers.
    let flat = abs(ray.axis) <= vec3<f32>(lean + 1e-7);
    let low = 1.0 / (ray.axis + lean);
    let high = 1.0 / (ray.axis - lean);
    let inner = room - back;
    let outer = room + slack;
    let one = min((-inner - p) * low, (inner - p) * high);
    let two = max((-outer - p) * low, (outer - p) * high);
    let starts = select(one, vec3<f32>(-1e30), flat);
    let ends = select(two, vec3<f32>(1e30), flat);
    let near = max(starts.x, max(starts.y, starts.z));
    let far = min(ends.x, min(ends.y, ends.z));
    let margin = distance_scene.detail * footprint(ray, distance_scene.far);
    let b = dot(p, ray.axis);
    let r = (distance_scene.radius + margin) * (1.0 + 1e-6);
    // From the centre to the ray's line. |p|^2 - b^2 would cancel.
    let off = p - b * ray.axis;
    let q = r * r - dot(off, off);
    if q < 0.0 {
        return vec2<f32>(1.0, -1.0);
    }
    let span = sqrt(q) * (1.0 + 1e-6);
    return vec2<f32>(max(near, -b - span), min(far, span - b));
}

/// One step of a cone.
fn advance(cone: Beam, at: Advance) -> Advance {
    let t = at.front;
    let q = cone.origin + t * cone.axis;
    let eps = distance_scene.detail * footprint(cone, t);
    let shell = distance_scene.shell * eps;
    var d = bounds_distance(q) - cone.r0 - shell;
    // How wide the cone is.
    let parallel = cone.grain == 0.0;
    let wide = select(cone.k * t, cone.r0, parallel);
    // Far from the bounds their distance is enough.
    if d <= 2.0 * wide {
        let p = scene_point(q);
        let most = distance_scene.iterations;
        var trial = select(4.0 * wide, distance_scene.first_trial, t == 0.0);
        trial = select(trial, DISTANCE_TRIAL * at.radius, at.radius > 0.0) + 2.0 * eps + cone.r0;
        var ball = 0.0;
        if DISTANCE_PROVEN {
            ball = f32(estimate_ball(p, most, real(trial)).y);
        } else {
            ball = f32(estimate_cone(p, most, real(trial)).y);
        }
        d = max(d, ball - shell - cone.r0);
    }
    let front = cone_front(t, t, d, cone.k);
    if parallel {
        let ball = d + cone.r0;
        let next = cone_parallel(t, ball, cone.r0, cone.k);
        return Advance(next, max(d, 0.0), u32(next - t > DISTANCE_ENOUGH * max(ball, 0.0)));
    }
    // After a short gain, or without a ball, the four thinner children go on.
    let going = front - t > DISTANCE_ENOUGH * max(d, 0.0);
    return Advance(front, max(d, 0.0), u32(going));
}

fn begin(ray: Beam, front: f32, t_max: f32) -> Walk {
    let span = bounds_interval(ray);
    var t = front;
    if distance_scene.clip == 1u {
        t = max(front, span.x);
    }
    var end = min(span.y, t_max);
    if span.x > span.y {
        end = -1.0;
    }
    return Walk(t, 0.0, 0.0, -1.0, 0.0, end);
}

/// One step of a ray: STATE_MOVING, STATE_HIT, or STATE_SKY beyond the end.
///
/// The next sample is `pace` ahead. If its ball and the last one leave a gap, the sample is
/// rejected, and the next one is at the edge of the last ball (Keinert et al. 2014). The
/// automatic pace extrapolates the radius linearly, so that the two balls just touch (Ban and
/// Valasek 2023).
fn walk_step(ray: Beam, walk: ptr<function, Walk>) -> u32 {
    let w = *walk;
    if w.t + w.radius > w.end {
        return STATE_SKY;
    }
    let t = min(w.t + w.pace, w.end);
    let gone = t - w.t;
    let eps = distance_scene.detail * footprint(ray, t);
    // A ray from an eye within the bounds has no ball and no threshold there. The field tells enough.
    let trial = select(DISTANCE_TRIAL * w.radius, w.room, w.radius == 0.0) + 2.0 * eps;
    let clear = distance_scene.shell * eps;
    let f = field(ray.origin + t * ray.axis, clear, trial);
    // Near a fold the ball may be tiny, and rays would creep.
    var least = DISTANCE_LEAST * eps;
    if DISTANCE_PROVEN {
        least = min(least, f.y + clear);
    }
    let radius = max(f.y, least) * distance_scene.stride;
    // Only a stretched step can leave a gap. Any other difference is rounding.
    if w.pace > w.radius && gone > w.radius + max(radius, 0.0) {
        (*walk).pace = w.radius;
        (*walk).slope = -1.0;
        return STATE_MOVING;
    }
    (*walk).t = t;
    if f.x <= eps {
        // Where the field meets the threshold, by its last two values. So a hit depends little on
        // where the ray's points are.
        let above = w.room - distance_scene.detail * footprint(ray, w.t);
        if above > 0.0 {
            (*walk).t = w.t + gone * (above / (above + (eps - f.x)));
        }
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
    (*walk).room = f.x;
    (*walk).slope = slope;
    (*walk).pace = radius * factor;
    return STATE_MOVING;
}

/// The first step of all rays from a point, as far as it does not depend on where they go.
struct Opening {
    walk: Walk,
}

/// The opening of rays from a point, whose footprint stays the same.
fn opening(q: vec3<f32>, grain: f32) -> Opening {
    // The first sample is at the point itself, wherever the ray goes.
    let ray = Beam(q, vec3<f32>(1.0, 0.0, 0.0), 0.0, 0.0, grain, 0.0);
    var walk = Walk(0.0, 0.0, 0.0, -1.0, 0.0, bounds_far());
    walk_step(ray, &walk);
    return Opening(walk);
}

/// A ray after its first step. If that may have ended it, or was not at the point, it is before
/// the step.
fn begin_opened(ray: Beam, reach: f32, opened: Opening) -> Walk {
    var walk = begin(ray, 0.0, reach);
    if walk.t == 0.0 && walk.end >= 0.0 && opened.walk.radius > 0.0 {
        let end = walk.end;
        walk = opened.walk;
        walk.end = end;
    }
    return walk;
}

/// The steps of a ray that were done when it began.
fn steps_opened(walk: Walk) -> u32 {
    return u32(walk.radius > 0.0);
}

/// Where the ray is.
fn walk_hit(ray: Beam, walk: Walk) -> Hit {
    return Hit(walk.t, 0u, vec2<f32>(0.0));
}

/// How far from the surface shadow rays start: beyond the threshold that would end them at once.
fn shadow_lift(grain: f32) -> f32 {
    return 4.0 * grain;
}

/// The radius of a ball about a point that should be empty.
fn clearance(q: vec3<f32>) -> f32 {
    let ball = estimate_step(scene_point(q), distance_scene.iterations, real(0.0)).y;
    return max(0.0, max(f32(ball), bounds_distance(q)));
}

/// The free room about a point, for occlusion.
fn room(q: vec3<f32>, enough: f32) -> f32 {
    return max(0.0, field_value(q));
}

/// A hit and, if `nearest` is not 0, the free room from this distance on. The normal is the gradient
/// over the corners of a tetrahedron half a pixel wide, the pigment comes from the orbit.
fn surroundings(ray: Beam, hit: Hit, nearest: f32) -> Surroundings {
    const X = vec4<f32>(1.0, -1.0, -1.0, 1.0);
    const Y = vec4<f32>(-1.0, -1.0, 1.0, 1.0);
    const Z = vec4<f32>(-1.0, 1.0, -1.0, 1.0);
    let q = ray.origin + hit.t * ray.axis;
    let h = 0.5 * footprint(ray, hit.t) + distance_scene.far * 1e-7;
    var x = h * X;
    var y = h * Y;
    var z = h * Z;
    // A point without a gradient faces the viewer.
    var normal = -ray.axis;
    var near = vec4<f32>(0.0);
    // Drivers compile a copy of the orbits for each call: so there is only one.
    let rounds = select(1u, 2u, nearest > 0.0);
    for (var i = 0u; i < rounds; i++) {
        near = field_values(q, x, y, z);
        if i > 0u {
            break;
        }
        let g = vec3<f32>(dot(near, X), dot(near, Y), dot(near, Z));
        let n = length(g);
        if n > 1e-20 {
            normal = g / n;
        }
        let along = nearest * vec4<f32>(1.0, 2.0, 4.0, 8.0);
        x = along * normal.x;
        y = along * normal.y;
        z = along * normal.z;
    }
    var rooms: array<f32, ROOMS>;
    if nearest > 0.0 {
        near = max(near, vec4<f32>(0.0));
        let far = 16.0 * nearest;
        rooms = array<f32, ROOMS>(near.x, near.y, near.z, near.w, room(q + far * normal, far));
    }
    let pigment = trap(scene_point(q), distance_scene.iterations);
    return Surroundings(Surface(normal, pigment), rooms);
}

/// A hit alone.
fn surface(ray: Beam, hit: Hit) -> Surface {
    return surroundings(ray, hit, 0.0).surface;
}
