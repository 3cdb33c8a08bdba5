// Ambient occlusion: how much of the sky a point sees, from the free room at a few distances
// along the normal. The distances double up to the reach.

fn occlusion(q: vec3<f32>, normal: vec3<f32>, grain: f32) -> f32 {
    var open = 1.0;
    // A program may be kept when the number becomes zero.
    if look.occlusion_strength == 0.0 {
        return open;
    }
    var h = max(look.occlusion_reach / 16.0, 2.0 * grain);
    var free = rooms(q, normal, h);
    let weight = 0.4 * look.occlusion_strength;
    for (var i = 0u; i < ROOMS; i++) {
        let tight = 1.0 - clamp(free[i] / h, 0.0, 1.0);
        open *= 1.0 - weight * tight * tight;
        h *= 2.0;
    }
    return open;
}
