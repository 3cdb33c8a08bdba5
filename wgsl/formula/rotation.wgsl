// A rotation between the folds of a formula. The CPU computes the rows of its matrix, as sine
// and cosine are too coarse in WGSL. The stand-in `rotation_off.wgsl` is the identity.

struct RotationUniform {
    row0: vec3<f32>,
    pad0: f32,
    row1: vec3<f32>,
    pad1: f32,
    row2: vec3<f32>,
    pad2: f32,
}

@group(0) @binding(2) var<storage, read> rotation_parameters: RotationUniform;
var<private> rotation: RotationUniform;

fn rotation_load() {
    rotation = rotation_parameters;
}

const ROTATES = true;

fn rotate(v: real3) -> real3 {
    return real3(
        dot(real3(rotation.row0), v),
        dot(real3(rotation.row1), v),
        dot(real3(rotation.row2), v),
    );
}
