// A round slab between two parallel planes, solved in closed form: the smallest complete scene.
// It has no distance estimate, no formula and no map. A hit carries its face and its
// coordinates on it.

struct SlabUniform {
    eye: vec3<f32>,
    /// Half thickness.
    half: f32,
    /// Unit normal of the planes. The slab is about the origin.
    normal: vec3<f32>,
    /// Radius of the disc.
    radius: f32,
    /// Two unit directions in the plane.
    side: vec3<f32>,
    far: f32,
    other: vec3<f32>,
    pad: f32,
}

/// A ray whose hit is already known: `begin` finds it, and the only step reports it.
struct Walk {
    t: f32,
    /// Shadow rays read this from rays that go on, but these rays end at once.
    radius: f32,
    /// Distance of the hit; negative if there is none.
    hit: f32,
    end: f32,
    /// 0 the lower plane, 1 the upper one, 2 the rim.
    face: u32,
    /// Coordinates of the hit along `side` and `other`.
    u: f32,
    v: f32,
}

override HIT_CARRIES_MARK: bool;

@group(0) @binding(0) var<storage, read> slab_parameters: SlabUniform;
var<private> slab: SlabUniform;

fn scene_load() {
    slab = slab_parameters;
}

fn bounds_far() -> f32 {
    return slab.far;
}

/// The distance to the solid disc; negative inside. It is the distance to a rectangle in the
/// plane of the distance from the axis and the height.
fn slab_distance(q: vec3<f32>) -> f32 {
    let p = slab.eye + q;
    let z = dot(p, slab.normal);
    let o = vec2<f32>(length(p - z * slab.normal) - slab.radius, abs(z) - slab.half);
    return length(max(o, vec2<f32>(0.0))) + min(max(o.x, o.y), 0.0);
}

/// One step of a cone. The distance is exact, so any gain is worth another step.
fn advance(cone: Beam, at: Advance) -> Advance {
    let front = at.front;
    count_evaluation();
    let d = slab_distance(cone.origin + front * cone.axis) - cone.r0;
    let next = cone_front(front, front, d, cone.k);
    return advance_at(next, next > front);
}

/// Finds the first of the planes and the rim that the ray enters.
fn begin(ray: Beam, front: f32, t_max: f32) -> Walk {
    count_evaluation();
    let p = slab.eye + ray.origin;
    let z = dot(p, slab.normal);
    let dz = dot(ray.axis, slab.normal);
    let s = vec2<f32>(dot(p, slab.side), dot(p, slab.other));
    let ds = vec2<f32>(dot(ray.axis, slab.side), dot(ray.axis, slab.other));
    var walk = Walk(front, 0.0, -1.0, min(slab.far, t_max), 0u, 0.0, 0.0);
    // Inside, the hit is where the ray starts.
    if slab_distance(ray.origin + front * ray.axis) <= 0.0 {
        walk.hit = front;
    }
    // Only the plane on the eye's side can be entered. The quotient of a ray along it would be
    // noise: only the rim counts.
    let face = select(-slab.half, slab.half, z > 0.0);
    if walk.hit < 0.0 && abs(z) > slab.half && abs(dz) > 1e-12 {
        let t = (face - z) / dz;
        let at = s + t * ds;
        if t >= front && length(at) <= slab.radius {
            walk.hit = t;
            walk.face = select(0u, 1u, z > 0.0);
        }
    }
    let a = dot(ds, ds);
    if walk.hit < 0.0 && a > 1e-12 {
        // From the nearest point of the line, as b^2 - a c would cancel for a far eye.
        let middle = -dot(s, ds) / a;
        let nearest = s + middle * ds;
        let q = slab.radius * slab.radius - dot(nearest, nearest);
        // The first of two crossings: at the second one the ray leaves.
        let t = middle - sqrt(max(q, 0.0) / a);
        if q > 0.0 && t >= front && abs(z + t * dz) <= slab.half {
            walk.hit = t;
            walk.face = 2u;
        }
    }
    if walk.hit >= 0.0 {
        let at = s + walk.hit * ds;
        walk.u = at.x;
        walk.v = at.y;
    }
    return walk;
}

fn walk_step(ray: Beam, walk: ptr<function, Walk>) -> u32 {
    let hit = (*walk).hit;
    if hit < 0.0 || hit > (*walk).end {
        return STATE_SKY;
    }
    (*walk).t = hit;
    return STATE_HIT;
}

fn walk_hit(ray: Beam, walk: Walk) -> Hit {
    return Hit(walk.t, walk.face, vec2<f32>(walk.u, walk.v));
}

/// How far from the surface shadow rays start: beyond the threshold that would end them at once.
fn shadow_lift(grain: f32) -> f32 {
    return 4.0 * grain;
}

fn clearance(q: vec3<f32>) -> f32 {
    count_evaluation();
    return max(0.0, slab_distance(q));
}

/// The free room about a point, for occlusion.
fn room(q: vec3<f32>, enough: f32) -> f32 {
    return clearance(q);
}

fn surface(ray: Beam, hit: Hit) -> Surface {
    var normal = slab.normal;
    if hit.id == 0u {
        normal = -slab.normal;
    }
    if hit.id == 2u {
        normal = (hit.uv.x * slab.side + hit.uv.y * slab.other) / slab.radius;
    }
    // A chessboard of unit squares.
    let square = floor(hit.uv.x) + floor(hit.uv.y);
    let light = square - 2.0 * floor(0.5 * square);
    return Surface(normal, vec3<f32>(0.15 + 0.7 * light, 0.5, 0.5));
}
