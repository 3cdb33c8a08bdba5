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
    // The point is one of four, of which each is in another direction.
    let nth = u32(q.c.z);
    var four = Points(
        p.x * real4(real(1.0), real(-0.7), real(0.3), real(-1.1)),
        p.y * real4(real(1.0), real(0.9), real(-1.2), real(0.2)),
        p.z * real4(real(1.0), real(-1.0), real(0.6), real(0.8)),
    );
    four.x[nth] = p.x;
    four.y[nth] = p.y;
    four.z[nth] = p.z;
    let one = estimate_four(four, most)[nth];
    return Numbers(
        vec4<f32>(high, low, f32(one), 0.0),
        vec4<f32>(trap(p, most), 0.0),
        vec4<f32>(f32(step.y), f32(ball.y), f32(cone.y), 0.0),
    );
}
