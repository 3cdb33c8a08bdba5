// Questions about several rays or points at once, of a scene that answers them one by one.

/// Rays from a point have nothing in common.
struct Opening {
    unused: u32,
}

fn opening(q: vec3<f32>, grain: f32) -> Opening {
    return Opening(0u);
}

fn begin_opened(ray: Beam, reach: f32, opened: Opening) -> Walk {
    return begin(ray, 0.0, reach);
}

fn steps_opened(walk: Walk) -> u32 {
    return 0u;
}

/// A hit and, if `nearest` is not 0, the free room from this distance on.
fn surroundings(ray: Beam, hit: Hit, nearest: f32) -> Surroundings {
    let found = surface(ray, hit);
    let q = ray.origin + hit.t * ray.axis;
    var rooms: array<f32, ROOMS>;
    if nearest > 0.0 {
        var h = nearest;
        for (var i = 0u; i < ROOMS; i++) {
            rooms[i] = room(q + h * found.normal, h);
            h *= 2.0;
        }
    }
    return Surroundings(found, rooms);
}
