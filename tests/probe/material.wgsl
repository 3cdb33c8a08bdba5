// What a material does with light: the direction that it chooses, what it sends back of it, and the
// random numbers behind. Pixel and sample are the bits of floats. Direction and albedo in.

fn answer(q: Numbers) -> Numbers {
    let seed = random_seed(bitcast<vec2<u32>>(q.c.xy));
    let numbers = random_pair(seed, bitcast<u32>(q.c.z), bitcast<u32>(q.c.w));
    let material = material_at(q.b.xyz, q.a.xyz);
    let frame = material_frame(q.a.xyz);
    let l = material_scatter(material, q.a.xyz, numbers, q.a.w);
    let up = normalize(vec3<f32>(l.xy, abs(l.z) + 0.01));
    return Numbers(
        vec4<f32>(numbers, l.xy),
        material_reflects(material, q.a.xyz, up, q.a.w),
        vec4<f32>(frame * q.b.xyz, l.z),
    );
}
