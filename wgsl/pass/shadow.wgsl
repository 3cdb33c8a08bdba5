// The shadow of a light: whether a ray from the point to the light meets a surface.

fn shadow(q: vec3<f32>, normal: vec3<f32>, grain: f32, lamp: Lamp) -> Shadow {
    let ray = Beam(q + shadow_lift(grain) * normal, lamp.axis, 0.0, 0.0, grain, 0.0);
    var walk = begin(ray, 0.0, lamp.far);
    for (var i = 0u; i < look.shadow_steps; i++) {
        let s = walk_step(ray, &walk);
        if s != STATE_MOVING {
            return Shadow(select(1.0, 0.0, s == STATE_HIT), s != STATE_UNCONVERGED);
        }
    }
    return Shadow(1.0, false);
}
