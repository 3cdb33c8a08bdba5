// Light by formulas: key light with a soft shadow, and light from the sky and from the ground with
// occlusion. `path.wgsl` takes its place where light is followed by rays.

/// Whether pixels are flagged whose rays of light reached their step limit.
const LIGHT_IS_FLAGGED = true;

/// The distance from which on the free room about a hit is asked for.
fn shade_nearest(grain: f32) -> f32 {
    return occlusion_nearest(grain);
}

/// Radiance that leaves a hit towards the eye, and 0 if the shadow ray reached its step limit,
/// else 1. `q` is the hit relative to the eye, `grain` half a pixel's width there.
fn shade(ray: Beam, q: vec3<f32>, at: Surroundings, grain: f32, pixel: vec2<u32>) -> vec4<f32> {
    let surface = at.surface;
    let n = surface.normal;
    let albedo = albedo_of(surface, q);
    let facing = dot(n, look.light);
    // A surface that faces away is dark: it needs no shadow ray.
    var light = Shadow(0.0, true);
    if facing > 0.0 {
        light = shadow(q, n, grain, Lamp(look.light, 2.0 * bounds_far(), look.softness));
    }
    let lit = facing * light.open;
    let open = occlusion(at.rooms, occlusion_nearest(grain));
    let up = 0.5 + 0.5 * dot(n, look.world_up);
    let ambient = sky_ambient(n);
    // Light from lit neighbours: warm, from below.
    let bounce = look.light_color * (0.12 * look.fill * (1.0 - up));
    var c = albedo * (look.light_color * (look.key * lit) + (ambient + bounce) * open);
    // Zero where the ray goes straight to the light. There is no direction then.
    let between = look.light - ray.axis;
    let half_way = between / max(length(between), 1e-20);
    // A narrow Blinn-Phong highlight.
    let shine = pow(max(0.0, dot(n, half_way)), 40.0);
    c += look.light_color * (look.gloss * lit * shine);
    for (var nth = 0u; nth < lamp_count(); nth++) {
        let lamp = lamp_from(nth, q);
        let to_lamp = dot(n, lamp.axis);
        let strength = lamp_light(nth, lamp);
        if to_lamp <= 0.0 || all(strength == vec3<f32>(0.0)) {
            continue;
        }
        let near = shadow(q, n, grain, lamp);
        c += albedo * (to_lamp * near.open) * strength;
        light.decided &= near.decided;
    }
    c += emission_of(surface);
    return vec4<f32>(c, select(0.0, 1.0, light.decided));
}
