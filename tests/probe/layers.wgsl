// The traps of a point, and the albedo of the layers over them.

fn answer(q: Numbers) -> Numbers {
    scene_load();
    look_load();
    let n = orbit_traps(scene_point(q.a.xyz), distance_scene.iterations);
    return Numbers(
        vec4<f32>(n[0], n[1], n[2], n[3]),
        vec4<f32>(n[4], n[5], n[6], 0.0),
        vec4<f32>(layers_albedo(q.a.xyz, q.b.xyz), 0.0),
    );
}
