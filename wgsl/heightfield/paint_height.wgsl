// The stand-in of `paint.wgsl`: height picks the hue.

fn relief_paint(cell: vec2<i32>, at: vec2<f32>, height: f32, up: f32) -> vec3<f32> {
    return vec3<f32>(height, up, 0.5);
}
