// The direction of a ray to a point of a light. Axis and softness, and the pair in.

fn answer(q: Numbers) -> Numbers {
    look_load();
    return Numbers(vec4<f32>(aim(Lamp(q.a.xyz, 0.0, q.a.w), q.b.xy), 0.0), vec4<f32>(0.0), vec4<f32>(0.0));
}
