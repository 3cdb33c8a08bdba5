// The stand-in of `fog.wgsl`: clear air.

fn fog(color: vec3<f32>, ray: Beam, t: f32) -> vec3<f32> {
    return color;
}
