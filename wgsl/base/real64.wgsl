// The stand-in of `base/real.wgsl` for adapters with 64-bit floats.

alias real = f64;
alias real2 = vec2<f64>;
alias real3 = vec3<f64>;
alias real4 = vec4<f64>;

/// Four points.
struct Points {
    x: real4,
    y: real4,
    z: real4,
}
