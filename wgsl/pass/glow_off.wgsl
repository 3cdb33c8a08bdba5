// The stand-in of `glow.wgsl`: dark air.

fn glow(ray: Beam, end: f32) -> vec3<f32> {
    return vec3<f32>(0.0);
}
