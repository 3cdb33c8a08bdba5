// The number type of formulas and scenes. With `base/real64.wgsl` in its place the same text
// computes in f64, if the adapter has it.

alias real = f32;
alias real2 = vec2<f32>;
alias real3 = vec3<f32>;
alias real4 = vec4<f32>;

/// Four points.
struct Points {
    x: real4,
    y: real4,
    z: real4,
}
