// The result of a step, the state of a pixel, and where a ray met the scene.

const STATE_SKY = 0u;
const STATE_HIT = 1u;
const STATE_UNCONVERGED = 2u;
/// Not finished: the next dispatch goes on. A frame never contains this state.
const STATE_MOVING = 3u;

/// A cone between two steps.
struct Advance {
    /// Every ray of the cone is proven free up to here.
    front: f32,
    /// The radius of the last ball; 0 before the first.
    radius: f32,
    /// 1 if another step is worth its cost.
    going: u32,
}

/// A cone at a front, with nothing known about what is ahead.
fn advance_at(front: f32, going: bool) -> Advance {
    return Advance(front, 0.0, u32(going));
}

/// Where a ray met the scene: the distance, the part that it met, and the place on it.
struct Hit {
    t: f32,
    id: u32,
    uv: vec2<f32>,
}
