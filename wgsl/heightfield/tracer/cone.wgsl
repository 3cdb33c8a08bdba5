// How far a cone lets a ray go on. All tracers with cones share it.

/// The shares of a ratio and of a way that are used: apexes, heights and crossings are rounded by
/// about 1e-7 each in f32.
const WALK_TRUST_RATIO = 1.0 - 1e-6;
const WALK_TRUST_WAY = 1.0 - 1e-5;
/// A quotient by less than this would leave the range of f32.
const WALK_SLIGHT = 1e-25;

/// How far a cone lets the ray go on, in s; `over` is the height above the apex.
fn cone_way(d: vec3<f32>, ratio: f32, over: f32, offset: f32) -> f32 {
    let reach = ratio * over - offset;
    if reach <= 0.0 {
        return 0.0;
    }
    let pace = length(d.xy) - d.z * ratio;
    if pace <= WALK_SLIGHT {
        return GRID_FAR;
    }
    return reach / pace;
}
