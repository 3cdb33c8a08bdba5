// Ambient occlusion: how much of the sky a point sees, from the free room at a few distances
// along the normal. The distances double up to the reach.

const OCCLUSION_TAPS = 5u;

fn occlusion(q: vec3<f32>, normal: vec3<f32>, grain: f32) -> f32 {
    var open = 1.0;
    // A program may be kept when the number becomes zero.
    if look.occlusion_strength == 0.0 {
        return open;
    }
    var h = max(look.occlusion_reach / 16.0, 2.0 * grain);
    var weight = 0.4;
    for (var i = 0u; i < OCCLUSION_TAPS; i++) {
        let free = clamp(room(q + h * normal, h) / h, 0.0, 1.0);
        open *= 1.0 - weight * look.occlusion_strength * (1.0 - free) * (1.0 - free);
        h *= 2.0;
    }
    return open;
}
