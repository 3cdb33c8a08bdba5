// The albedo of a hit by the formula's own traps.

fn layers_albedo(q: vec3<f32>, pigment: vec3<f32>) -> vec3<f32> {
    return pigment_color(pigment);
}
