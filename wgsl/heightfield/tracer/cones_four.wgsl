// Four cones for each sample, one for each side: +x, -x, +y, -y.

/// The ratio at a sample, for the side that the ray goes to.
fn cones_ratio(d: vec3<f32>, at: vec2<i32>) -> f32 {
    var side = select(0, 1, d.x < 0.0);
    if abs(d.x) < abs(d.y) {
        side = select(2, 3, d.y < 0.0);
    }
    return ratios_at(u32(4 * cones_place(at) + side));
}
