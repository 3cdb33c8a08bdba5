// Ambient occlusion: how much of the sky a point sees, from the free room at a few distances
// along the normal. The distances double up to the reach.

/// The least of these distances; 0 for no occlusion.
fn occlusion_nearest(grain: f32) -> f32 {
    let nearest = max(look.occlusion_reach / 16.0, 2.0 * grain);
    // A program may be kept when the number becomes zero.
    return select(0.0, nearest, look.occlusion_strength > 0.0);
}

fn occlusion(rooms: array<f32, ROOMS>, nearest: f32) -> f32 {
    var open = 1.0;
    if nearest == 0.0 {
        return open;
    }
    var free = rooms;
    var h = nearest;
    let weight = 0.4 * look.occlusion_strength;
    for (var i = 0u; i < ROOMS; i++) {
        let tight = 1.0 - clamp(free[i] / h, 0.0, 1.0);
        open *= 1.0 - weight * tight * tight;
        h *= 2.0;
    }
    return open;
}
