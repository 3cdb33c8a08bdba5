// The number type that formulas and scenes compute in. Joining `base/real64.wgsl`
// instead compiles the very same text in f64 where an adapter has it.

alias real = f32;
alias real3 = vec3<f32>;
