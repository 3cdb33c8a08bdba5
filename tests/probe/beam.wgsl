// A beam in any scene: what it is told of a cone, of a ray after so many steps, and of
// a point. Origin and front, axis and chord, r0, grain, t_max and steps in.

fn answer(q: Numbers) -> Numbers {
    scene_load();
    let beam = Beam(q.a.xyz, q.b.xyz, q.c.x, q.b.w, 0.0, q.c.y);
    let next = advance(beam, advance_at(q.a.w, true));
    var walk = begin(beam, q.a.w, q.c.z);
    var s = STATE_MOVING;
    for (var i = 0u; i < u32(q.c.w) && s == STATE_MOVING; i++) {
        s = walk_step(beam, &walk);
    }
    let hit = walk_hit(beam, walk);
    let at = beam.origin + q.a.w * beam.axis;
    return Numbers(
        vec4<f32>(next.front, f32(next.going), clearance(at), bounds_far()),
        vec4<f32>(hit.t, f32(s), f32(hit.id), 0.0),
        vec4<f32>(hit.uv, 0.0, 0.0),
    );
}
