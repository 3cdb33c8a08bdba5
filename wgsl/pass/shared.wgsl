// What every pass and every scene agree on: states, hits, surfaces, and which cell
// an invocation works on.
//
// Parameters lie in storage buffers. Every file that has some copies them once, in its
// `NAME_load`, which entry points call before any branch: there a software device reads
// a number once for all lanes, later once for each lane in turn, which took as long as
// all the arithmetic of an evaluation.

const STATE_SKY = 0u;
const STATE_HIT = 1u;
const STATE_UNCONVERGED = 2u;
/// Not finished: runs on in the next dispatch. Never leaves the executor.
const STATE_MOVING = 3u;

/// A cone's new proven front, and whether another step is worth its price.
struct Advance {
    front: f32,
    going: bool,
}

/// Where a ray met the scene: the distance, what it met, and where on that.
struct Hit {
    t: f32,
    id: u32,
    uv: vec2<f32>,
}

/// What of a hit is kept between the passes, beside its distance: only scenes whose
/// hits name something keep any.
struct Mark {
    id: u32,
    u: f32,
    v: f32,
}

struct Surface {
    normal: vec3<f32>,
    /// Three numbers in 0..1 that the palette is looked up with.
    pigment: vec3<f32>,
}

/// Square tiles of 8 x 8 cells, walked in Morton order: neighbouring invocations are
/// neighbouring cells, in groups of 8 (4 x 2) as in groups of 32 (8 x 4).
fn tile_cell(group: vec2<u32>, lane: u32) -> vec2<u32> {
    let x = (lane & 1u) | ((lane >> 1u) & 2u) | ((lane >> 2u) & 4u);
    let y = ((lane >> 1u) & 1u) | ((lane >> 2u) & 2u) | ((lane >> 3u) & 4u);
    return group * 8u + vec2<u32>(x, y);
}
