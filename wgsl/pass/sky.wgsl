// The light of the sky: two colours, and a halo about the sun. `sky_file.wgsl` takes its place.

/// Whether directions are sampled by the light of the sky.
const SKY_IS_SAMPLED = false;

fn sky(axis: vec3<f32>) -> vec3<f32> {
    let height = dot(axis, look.world_up);
    let blend = smoothstep(-0.6, 0.8, height);
    return mix(look.sky_low, look.sky_high, blend) + sky_halo(axis);
}

/// The wide, faint halo about the light in the radiance of the sky.
fn sky_halo(axis: vec3<f32>) -> vec3<f32> {
    let near = max(0.0, dot(axis, look.light));
    return look.light_color * (0.12 * pow(near, 6.0));
}

/// Radiance that comes from the sky or the ground to a surface.
fn sky_light(axis: vec3<f32>) -> vec3<f32> {
    let blend = smoothstep(-0.6, 0.8, dot(axis, look.world_up));
    let below = look.ground * look.sky_low;
    return (mix(below, look.sky_high, blend) + sky_halo(axis)) * look.fill;
}

/// Radiance of fog in a direction.
fn sky_haze(axis: vec3<f32>) -> vec3<f32> {
    return sky(axis);
}

/// Radiance of a white wall with a normal that nothing but sky and ground lights.
fn sky_ambient(normal: vec3<f32>) -> vec3<f32> {
    // From 0 for a surface that faces down to 1 for one that faces up. The ground absorbs
    // a part of the light of the lower sky.
    let up = 0.5 + 0.5 * dot(normal, look.world_up);
    return mix(look.ground * look.sky_low, look.sky_high, up) * look.fill;
}

/// Never used: this sky is so even that the material alone samples it well.
fn sky_toward(cell: vec2<f32>, pair: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(look.world_up, 0.0);
}

fn sky_density(axis: vec3<f32>) -> f32 {
    return 0.0;
}
