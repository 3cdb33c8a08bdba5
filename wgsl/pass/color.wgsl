// The colour pass: key light with shadow, light from the sky and from the ground with
// occlusion, and fog. Light is linear. Tone and sRGB follow when the picture is written.

override COLOR_KEEPS_NORMALS: bool;
/// Whether pigments are linear colours.
override COLOR_IS_PIGMENT: bool;

/// Radiance that leaves a hit towards the eye, and 0 if the shadow ray reached its step limit,
/// else 1. `q` is the hit relative to the eye, `grain` half a pixel's width there.
fn shade(ray: Beam, q: vec3<f32>, surface: Surface, grain: f32) -> vec4<f32> {
    let n = surface.normal;
    var albedo = surface.pigment;
    if !COLOR_IS_PIGMENT {
        albedo = layers_albedo(q, surface.pigment);
    }
    let facing = dot(n, look.light);
    // A surface that faces away is dark: it needs no shadow ray.
    var light = Shadow(0.0, true);
    if facing > 0.0 {
        light = shadow(q, n, grain);
    }
    let lit = facing * light.open;
    let open = occlusion(q, n, grain);
    // From 0 for a surface that faces down to 1 for one that faces up. The lower sky is dimmed,
    // as the ground absorbs more than half of the light.
    let up = 0.5 + 0.5 * dot(n, look.world_up);
    let ambient = mix(0.45 * look.sky_low, look.sky_high, up) * look.fill;
    // Light from lit neighbours: warm, from below.
    let bounce = look.light_color * (0.12 * look.fill * (1.0 - up));
    var c = albedo * (look.light_color * (look.key * lit) + (ambient + bounce) * open);
    // Zero where the ray goes straight to the light. There is no direction then.
    let between = look.light - ray.axis;
    let half_way = between / max(length(between), 1e-20);
    // A narrow Blinn-Phong highlight.
    let shine = pow(max(0.0, dot(n, half_way)), 40.0);
    c += look.light_color * (look.gloss * lit * shine);
    return vec4<f32>(c, select(0.0, 1.0, light.decided));
}

@compute @workgroup_size(64)
fn color(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    scene_load();
    view_load();
    look_load();
    queue_load();
    // Every pixel gets a colour, also the sky.
    let packed = queue_tile(group.xy, lane);
    if packed == QUEUE_NONE {
        return;
    }
    let cell = queue_cell(packed);
    let index = queue_index(cell);
    let ray = view_ray_from(turn.stage.origin + cell, turn.stage.place, turn.stage.lens);
    let s = cell_state(turn.stage.state + index);
    var c = sky(ray.axis);
    var decided = 1.0;
    var n = vec3<f32>(0.0);
    // A pixel under a sky cell was never written: it is sky.
    if s == STATE_HIT || s == STATE_UNCONVERGED {
        var hit = Hit(cell_front(index), 0u, vec2<f32>(0.0));
        if HIT_CARRIES_MARK {
            let mark = cell_mark(index);
            hit.id = mark.id;
            hit.uv = vec2<f32>(mark.u, mark.v);
        }
        let at = surface(ray, hit);
        // An unconverged ray is lit where it stopped, mostly close to a surface.
        let grain = footprint(ray, hit.t);
        let shaded = shade(ray, ray.origin + hit.t * ray.axis, at, grain);
        c = fog(shaded.rgb, ray.axis, hit.t);
        decided = shaded.w;
        n = at.normal;
        if look.flag == 1u && (s == STATE_UNCONVERGED || decided == 0.0) {
            c = vec3<f32>(1.0, 0.0, 1.0);
        }
    }
    if turn.stage.before > 0u {
        let sum = cell_pixel(index);
        c = sum.rgb + select(vec3<f32>(0.0), c, turn.stage.weight > 0.0);
        decided = min(decided, sum.a);
    }
    cell_store_pixel(index, vec4<f32>(c * turn.stage.scale, decided));
    if COLOR_KEEPS_NORMALS {
        let area = turn.stage.cells.x * turn.stage.cells.y;
        cell_store_pixel(area + index, vec4<f32>(n, 0.0));
    }
}
