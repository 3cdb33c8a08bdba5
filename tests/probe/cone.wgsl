// The cone rule: front, sample, ball and chord in, the new front out.

fn answer(q: Numbers) -> Numbers {
    let front = cone_front(q.a.x, q.a.y, q.a.z, q.a.w);
    return Numbers(vec4<f32>(front, 0.0, 0.0, 0.0), vec4<f32>(0.0), vec4<f32>(0.0));
}
