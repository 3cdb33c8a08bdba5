// What passes and scenes share: states, hits, surfaces, and the cell of an invocation.
//
// Parameters are in storage buffers. Each file copies its parameters in its `NAME_load`, which
// entry points call before any branch. There a software device reads a number once for all
// lanes. Later it would read it once per lane, which takes as long as all the arithmetic of an
// evaluation.

const STATE_SKY = 0u;
const STATE_HIT = 1u;
const STATE_UNCONVERGED = 2u;
/// Not finished: the next dispatch goes on. A frame never contains this state.
const STATE_MOVING = 3u;

/// Distances along a normal at which occlusion asks for the free room.
const ROOMS = 5u;

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

/// What is kept of a hit between the passes, beside its distance. Only some scenes need it.
struct Mark {
    id: u32,
    u: f32,
    v: f32,
}

struct Surface {
    normal: vec3<f32>,
    /// Three numbers from 0 to 1 that pick a colour of the palette, or a linear colour.
    pigment: vec3<f32>,
}

/// The cell of an invocation. Tiles of 8 x 8 cells are visited in Morton order, so neighbouring
/// invocations have neighbouring cells, in groups of 8 (4 x 2) and of 32 (8 x 4).
fn tile_cell(group: vec2<u32>, lane: u32) -> vec2<u32> {
    let x = (lane & 1u) | ((lane >> 1u) & 2u) | ((lane >> 2u) & 4u);
    let y = ((lane >> 1u) & 1u) | ((lane >> 2u) & 2u) | ((lane >> 3u) & 4u);
    return group * 8u + vec2<u32>(x, y);
}
