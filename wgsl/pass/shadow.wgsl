// The soft shadow of a light. A ray goes from the point to the light: a hit is full
// shadow, and the narrowest empty ball on the way gives the penumbra.

fn shadow(q: vec3<f32>, normal: vec3<f32>, grain: f32, lamp: Lamp) -> Shadow {
    let ray = Beam(q + shadow_lift(grain) * normal, lamp.axis, 0.0, 0.0, grain, 0.0);
    var walk = begin(ray, 0.0, lamp.far);
    var open = 1.0;
    var decided = false;
    for (var i = 0u; i < look.shadow_steps; i++) {
        let s = walk_step(ray, &walk);
        if s == STATE_HIT {
            return Shadow(0.0, true);
        }
        if s != STATE_MOVING {
            decided = s == STATE_SKY;
            break;
        }
        if walk.t > 4.0 * grain {
            open = min(open, walk_radius(ray, walk) / (lamp.softness * walk.t));
        }
    }
    return Shadow(smoothstep(0.0, 1.0, open), decided);
}
