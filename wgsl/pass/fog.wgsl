// Exponential fog, which blends towards the sky with the distance from the eye.

fn fog(color: vec3<f32>, ray: Beam, t: f32) -> vec3<f32> {
    // A program may be kept when the number becomes zero; `mix` would round.
    if look.fog == 0.0 {
        return color;
    }
    let seen = exp(-fog_depth(ray, t));
    return mix(sky_haze(ray.axis), color, seen);
}
