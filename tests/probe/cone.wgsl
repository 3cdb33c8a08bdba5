// The cone rule: front, sample, ball and chord in, the new front out.

fn answer(q: Numbers) -> Numbers {
    return Numbers(vec4<f32>(cone_front(q.a.x, q.a.y, q.a.z, q.a.w)), vec4<f32>(), vec4<f32>());
}
