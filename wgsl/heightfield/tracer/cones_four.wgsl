// Four cones for each sample, one for each side: +x, -x, +y, -y.

/// A texture, as four cones for each of 4096 x 4096 samples exceed the size of a buffer.
@group(0) @binding(9) var ratios_of_sides: texture_2d<f32>;

/// The ratio at a sample, for the side that the ray goes to.
fn cones_ratio(d: vec3<f32>, at: vec2<i32>) -> f32 {
    var side = select(0, 1, d.x < 0.0);
    if abs(d.x) < abs(d.y) {
        side = select(2, 3, d.y < 0.0);
    }
    let place = array_texel(u32(4 * cones_place(at) + side));
    return textureLoad(ratios_of_sides, place, 0).x;
}
