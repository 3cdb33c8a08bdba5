// The part of a ray that is near the bounds.

fn answer(q: Numbers) -> Numbers {
    scene_load();
    let beam = Beam(q.a.xyz, q.b.xyz, 0.0, 0.0, 0.0, q.c.y);
    let span = bounds_interval(beam);
    return Numbers(vec4<f32>(span, 0.0, 0.0), vec4<f32>(0.0), vec4<f32>(0.0));
}
