// Light that the surface itself sends out, where the orbit comes near a trap.

fn emission(pigment: vec3<f32>) -> vec3<f32> {
    let trap = pigment[look.emission_trap];
    let near = max(0.0, 1.0 - trap / look.emission_width);
    return look.emission * (near * near);
}
