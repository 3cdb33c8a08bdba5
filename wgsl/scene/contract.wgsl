// What passes ask a scene. Each scene has the functions of `Solid` in `src/scene/contract.rs`.

/// Distances along a normal at which occlusion asks for the free room.
const ROOMS = 5u;

struct Surface {
    normal: vec3<f32>,
    /// Three numbers from 0 to 1 that pick a colour of the palette, or a linear colour.
    pigment: vec3<f32>,
}

/// A hit, and the free room at ROOMS distances along its normal, of which each is twice the one
/// before.
struct Surroundings {
    surface: Surface,
    rooms: array<f32, ROOMS>,
}
