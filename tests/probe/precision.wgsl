// A formula's estimate at a point given as the sum of two f32, told as the sum of two: what
// f64 knows of either is not lost on the way.

fn answer(q: Numbers) -> Numbers {
    formula_load();
    let e = estimate(real3(q.a.xyz) + real3(q.b.xyz), u32(q.a.w));
    let high = f32(e);
    let low = f32(e - real(high));
    return Numbers(vec4<f32>(high, low, 0.0, 0.0), vec4<f32>(0.0), vec4<f32>(0.0));
}
