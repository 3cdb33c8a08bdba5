// A ray over a height surface: origin and start, direction and end, and the steps that it may
// take in; where it ended, its state, what it met and its steps out.

@group(0) @binding(0) var<storage, read> heightmap_parameters: HeightmapUniform;

fn answer(q: Numbers) -> Numbers {
    heightmap = heightmap_parameters;
    var trace = trace_begin(q.a.xyz, q.b.xyz, q.a.w, q.b.w);
    var s = STATE_MOVING;
    var steps = 0u;
    for (; steps < u32(q.c.x) && s == STATE_MOVING; steps++) {
        s = trace_step(q.a.xyz, q.b.xyz, &trace);
    }
    let hit = trace_hit(q.a.xyz, q.b.xyz, trace);
    return Numbers(
        vec4<f32>(hit.t, f32(s), f32(hit.id & 0xffffu), f32(hit.id >> 16u)),
        vec4<f32>(hit.uv, f32(steps), 0.0),
        vec4<f32>(0.0),
    );
}
