// The palette, the colour of a pigment, and the sky.

fn answer(q: Numbers) -> Numbers {
    look_load();
    return Numbers(
        vec4<f32>(palette_at(q.a.x), 0.0),
        vec4<f32>(sky(q.b.xyz), 0.0),
        vec4<f32>(pigment_color(q.c.xyz), 0.0),
    );
}
