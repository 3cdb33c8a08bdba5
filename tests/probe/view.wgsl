// The ray of a pixel, and the cone of the cell that a divisor puts it in.

fn answer(q: Numbers) -> Numbers {
    view_load();
    let pixel = vec2<u32>(q.a.xy);
    let divisor = u32(q.a.z);
    let ray = view_ray(pixel);
    let cone = view_cone(pixel / divisor, divisor);
    return Numbers(
        vec4<f32>(ray.axis, ray.grain),
        vec4<f32>(cone.axis, cone.grain),
        vec4<f32>(cone.k, ray.k, cone.r0, 0.0),
    );
}
