// How far the cone over a place lets a ray go on: what all tracers with cones share.

/// Shares of ratio and way that f32 may use: apexes, heights and crossings are rounded
/// by about 1e-7 each.
const WALK_TRUST_RATIO = 1.0 - 1e-6;
const WALK_TRUST_WAY = 1.0 - 1e-5;
/// A quotient below this would leave the range of f32.
const WALK_SLIGHT = 1e-25;

/// How far a cone lets the ray go on, in s; `over` is the height above the apex.
fn cone_way(d: vec3<f32>, ratio: f32, over: f32, offset: f32) -> f32 {
    let reach = ratio * over - offset;
    if reach <= 0.0 {
        return 0.0;
    }
    let pace = length(d.xy) - d.z * ratio;
    if pace <= WALK_SLIGHT {
        return COURSE_FAR;
    }
    return reach / pace;
}
