// Four cones for each sample, one for each side: +x and -x in `ratios`, +y and -y in a second
// buffer, because all four of 4096 x 4096 samples may exceed a binding.

@group(0) @binding(9) var<storage, read> ratios_y: array<f32>;

/// The ratio at a sample, for the side that the ray goes to.
fn cones_ratio(d: vec3<f32>, at: vec2<i32>) -> f32 {
    let place = 2 * cones_place(at);
    if abs(d.x) >= abs(d.y) {
        return ratios[place + select(0, 1, d.x < 0.0)];
    }
    return ratios_y[place + select(0, 1, d.y < 0.0)];
}
