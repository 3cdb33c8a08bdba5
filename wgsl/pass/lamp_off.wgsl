// The stand-in of `lamp.wgsl`: there is no lamp.

fn lamp_from(q: vec3<f32>) -> Lamp {
    return Lamp(vec3<f32>(0.0), 0.0, 0.0);
}

fn lamp_light(far: f32) -> vec3<f32> {
    return vec3<f32>(0.0);
}
