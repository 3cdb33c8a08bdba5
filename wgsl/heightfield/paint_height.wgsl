// The pigment of a height surface by its height. Stands in for `paint.wgsl`.

fn heightmap_paint(cell: vec2<i32>, at: vec2<f32>, height: f32, up: f32) -> vec3<f32> {
    return vec3<f32>(height, up, 0.5);
}
