// A cone in any scene: origin and front, axis and chord, r0 and steps in; the front after so many
// steps out.

fn answer(q: Numbers) -> Numbers {
    scene_load();
    let cone = Beam(q.a.xyz, q.b.xyz, q.c.x, q.b.w, 0.0, 0.0);
    var next = advance_at(q.a.w, true);
    for (var i = 0u; i < u32(q.c.y) && next.going == 1u && next.front <= bounds_far(); i++) {
        next = advance(cone, next);
    }
    return Numbers(vec4<f32>(next.front, f32(next.going), 0.0, 0.0), vec4<f32>(), vec4<f32>());
}
