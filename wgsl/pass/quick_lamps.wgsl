// The light of lamps by formulas: each with a shadow ray.

/// Adds it to a radiance, whose last number stays 1 if every shadow ray reaches its end.
fn quick_lamps(
    lit: vec4<f32>,
    material: Material,
    v: vec3<f32>,
    frame: mat3x3<f32>,
    q: vec3<f32>,
    n: vec3<f32>,
    grain: f32,
    pixel: vec2<u32>,
) -> vec4<f32> {
    var c = lit;
    // Shadow rays start here. The strength is that of the point itself, whatever the size of a pixel.
    let start = q + shadow_lift(grain) * n;
    for (var nth = 0u; nth < lamp_count(); nth++) {
        let lamp = lamp_from(nth, q);
        let to_lamp = lamp.axis * frame;
        let strength = lamp_light(nth, lamp);
        if to_lamp.z <= 0.0 || all(strength == vec3<f32>(0.0)) {
            continue;
        }
        let near = shadow(q, n, grain, quick_lamp(lamp_from(nth, start), nth + 1u, pixel));
        let light = material_reflects(material, v, to_lamp, lamp.softness).rgb * (PI * near.open * strength);
        c = vec4<f32>(c.rgb + light, select(0.0, c.w, near.decided));
    }
    return c;
}
