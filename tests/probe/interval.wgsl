// The part of a ray that is near the bounds.

fn answer(q: Numbers) -> Numbers {
    scene_load();
    let span = bounds_interval(Beam(q.a.xyz, q.b.xyz, 0.0, 0.0, 0.0, q.c.y));
    return Numbers(vec4<f32>(span, 0.0, 0.0), vec4<f32>(), vec4<f32>());
}
