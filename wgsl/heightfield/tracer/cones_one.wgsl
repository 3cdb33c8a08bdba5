// One cone for each sample.

/// The ratio at a sample.
fn cones_ratio(d: vec3<f32>, at: vec2<i32>) -> f32 {
    return ratios[cones_place(at)];
}
