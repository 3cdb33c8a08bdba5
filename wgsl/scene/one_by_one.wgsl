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

/// The free room at ROOMS distances from a point, of which each is twice the one before.
fn rooms(q: vec3<f32>, axis: vec3<f32>, nearest: f32) -> array<f32, ROOMS> {
    var all: array<f32, ROOMS>;
    var h = nearest;
    for (var i = 0u; i < ROOMS; i++) {
        all[i] = room(q + h * axis, h);
        h *= 2.0;
    }
    return all;
}
