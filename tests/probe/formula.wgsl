// A formula at a point: its estimate and its orbit traps.

fn answer(q: Numbers) -> Numbers {
    formula_load();
    let p = real3(q.a.xyz);
    let most = u32(q.a.w);
    let e = f32(estimate(p, most));
    return Numbers(vec4<f32>(e, 0.0, 0.0, 0.0), vec4<f32>(trap(p, most), 0.0), vec4<f32>(0.0));
}
