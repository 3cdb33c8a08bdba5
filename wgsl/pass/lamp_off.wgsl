// The stand-in of `lamp.wgsl`: there is no lamp.

fn lamp_count() -> u32 {
    return 0u;
}

fn lamp_from(nth: u32, q: vec3<f32>) -> Lamp {
    return Lamp(vec3<f32>(0.0), 0.0, 0.0);
}

fn lamp_light(nth: u32, lamp: Lamp) -> vec3<f32> {
    return vec3<f32>(0.0);
}
