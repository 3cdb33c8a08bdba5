// The stand-in of `emission.wgsl`: no surface glows.

fn emission(pigment: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(0.0);
}
