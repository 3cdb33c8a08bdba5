// Balls, boxes and a rod with an exact distance. Tests of cones on them need no tolerance.

struct BallsUniform {
    /// Centre and radius of each ball.
    ball0: vec4<f32>,
    ball1: vec4<f32>,
    ball2: vec4<f32>,
    /// Centre of each box, and its half edge.
    box0: vec4<f32>,
    box1: vec4<f32>,
    /// A vertical rod: its x and y, half its height, its radius.
    rod: vec4<f32>,
}

@group(0) @binding(1) var<storage, read> balls_parameters: BallsUniform;
var<private> balls: BallsUniform;

fn formula_load() {
    balls = balls_parameters;
}

/// The distance is exact.
fn formula_lipschitz() -> f32 {
    return 1.0;
}

fn balls_ball(p: real3, s: vec4<f32>) -> real {
    return length(p - real3(s.xyz)) - real(s.w);
}

fn balls_box(p: real3, s: vec4<f32>) -> real {
    let q = abs(p - real3(s.xyz)) - real3(real(s.w));
    let outside = max(q, real3(real(0.0)));
    return length(outside) + min(max(q.x, max(q.y, q.z)), real(0.0));
}

fn balls_rod(p: real3, s: vec4<f32>) -> real {
    let z = clamp(p.z, real(-s.z), real(s.z));
    return length(p - real3(real(s.x), real(s.y), z)) - real(s.w);
}

fn estimate(p: real3, most: u32) -> real {
    count_evaluation();
    count_iterations(1u);
    var d = balls_ball(p, balls.ball0);
    d = min(d, balls_ball(p, balls.ball1));
    d = min(d, balls_ball(p, balls.ball2));
    d = min(d, balls_box(p, balls.box0));
    d = min(d, balls_box(p, balls.box1));
    return min(d, balls_rod(p, balls.rod));
}

fn trap(p: real3, most: u32) -> vec3<f32> {
    let a = abs(p - round(p));
    return vec3<f32>(f32(a.x), f32(a.y), f32(a.z)) * 2.0;
}
