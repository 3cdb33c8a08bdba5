// A formula at a point: its orbit traps, its estimate and its balls. The point is given, and the
// estimate told, as the sum of two f32, so that no digit of an f64 is lost on the way.

fn answer(q: Numbers) -> Numbers {
    formula_load();
    let p = real3(q.a.xyz) + real3(q.b.xyz);
    let most = u32(q.a.w);
    let e = estimate(p, most);
    let high = f32(e);
    let low = f32(e - real(high));
    let step = estimate_step(p, most, real(q.c.x));
    let ball = estimate_ball(p, most, real(q.c.y));
    let cone = estimate_cone(p, most, real(q.c.y));
    return Numbers(
        vec4<f32>(high, low, 0.0, 0.0),
        vec4<f32>(trap(p, most), 0.0),
        vec4<f32>(f32(step.y), f32(ball.y), f32(cone.y), 0.0),
    );
}
