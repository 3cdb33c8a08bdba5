// A point of a surface in its light: shadow, occlusion and fog, and the surface itself.

fn answer(q: Numbers) -> Numbers {
    scene_load();
    look_load();
    let ray = Beam(vec3<f32>(0.0), q.b.xyz, 0.0, 0.0, 0.0, q.b.w);
    let grain = footprint(ray, q.a.w);
    let nearest = occlusion_nearest(grain);
    let around = surroundings(ray, Hit(q.a.w, 0u, vec2<f32>(0.0)), nearest);
    let at = around.surface;
    let sun = Lamp(look.light, 2.0 * bounds_far(), look.softness);
    let near = lamp_from(0u, q.a.xyz);
    return Numbers(
        vec4<f32>(at.normal, shadow(q.a.xyz, q.c.xyz, grain, sun).open),
        vec4<f32>(at.pigment, occlusion(around.rooms, nearest)),
        vec4<f32>(fog(vec3<f32>(0.2, 0.5, 0.9), ray, q.a.w), near.softness),
    );
}
