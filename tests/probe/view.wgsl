// The ray through a place of a pixel, and the cone of the cell that a divisor puts it in: their
// directions, or where they start.

fn answer(q: Numbers) -> Numbers {
    view_load();
    let pixel = vec2<u32>(q.a.xy);
    let divisor = u32(q.a.z);
    let ray = view_ray_at(pixel, vec2<f32>(0.5) + q.b.xy);
    let cone = view_cone(pixel / divisor, divisor);
    if q.a.w > 0.0 {
        return Numbers(
            vec4<f32>(ray.origin, ray.grain0),
            vec4<f32>(cone.origin, cone.grain0),
            vec4<f32>(cone.k, ray.k, cone.r0, ray.r0),
        );
    }
    return Numbers(
        vec4<f32>(ray.axis, ray.grain),
        vec4<f32>(cone.axis, cone.grain),
        vec4<f32>(cone.k, ray.k, cone.r0, ray.r0),
    );
}
