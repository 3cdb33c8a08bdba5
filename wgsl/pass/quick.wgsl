// Light by formulas: the sun and lamps with a shadow ray each, and light from the sky and from the ground
// with occlusion. `path.wgsl` takes its place where light is followed by rays.

/// Whether pixels are flagged whose rays of light reached their step limit.
const LIGHT_IS_FLAGGED = true;

/// The distance from which on the free room about a hit is asked for.
fn shade_nearest(grain: f32) -> f32 {
    return occlusion_nearest(grain);
}

/// A light as a sample sees it: a point of its disc, the same as at the first hit of a path.
fn quick_lamp(lamp: Lamp, nth: u32, pixel: vec2<u32>) -> Lamp {
    if look.discs == 0u {
        return lamp;
    }
    let pair = random_pair(random_seed(pixel), turn.stage.before, aim_purpose(0u, nth));
    return Lamp(aim(lamp, pair), lamp.far, lamp.softness);
}

/// Radiance that leaves a hit towards the eye, and 0 if the shadow ray reached its step limit,
/// else 1. `q` is the hit relative to the eye, `grain` half a pixel's width there.
fn shade(ray: Beam, q: vec3<f32>, at: Surroundings, grain: f32, pixel: vec2<u32>) -> vec4<f32> {
    let surface = at.surface;
    let n = surface.normal;
    let frame = material_frame(n);
    let v = material_view(-ray.axis * frame);
    let material = material_at(min(albedo_of(surface, q), vec3<f32>(1.0)), v);
    let sun = look.light * frame;
    var c = emission_of(surface);
    var decided = true;
    // A surface that faces away is dark: it needs no shadow ray.
    if sun.z > 0.0 {
        let disc = Lamp(look.light, 2.0 * bounds_far(), look.softness);
        let light = shadow(q, n, grain, quick_lamp(disc, 0u, pixel));
        c += material_reflects(material, v, sun, look.softness).rgb * (PI * look.key * light.open * look.light_color);
        decided = light.decided;
    }
    let open = occlusion(at.rooms, occlusion_nearest(grain));
    let up = 0.5 + 0.5 * dot(n, look.world_up);
    // Light from lit neighbours: warm, from below.
    let bounce = look.light_color * (0.12 * look.fill * (1.0 - up));
    c += material.base * (sky_ambient(n) + bounce) * open;
    // What the coat mirrors is more often near and dark: in hollows, and where it is seen at a slant.
    let mirrored = sky_ambient(reflect(ray.axis, n));
    let coated = open * open * open * open * min(1.0, 2.0 * v.z);
    c += material.coat * mirrored * coated;
    return quick_lamps(vec4<f32>(c, select(0.0, 1.0, decided)), material, v, frame, q, n, grain, pixel);
}
