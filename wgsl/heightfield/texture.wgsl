// A picture over a height surface, once for each tile, interpolated between its texels.

/// Columns, rows, then texels row by row: sRGB of 8 bits, red in the low byte.
@group(0) @binding(8) var texels: texture_2d<u32>;

fn texels_at(i: i32) -> u32 {
    return textureLoad(texels, array_texel(u32(i)), 0).x;
}

/// sRGB to linear (IEC 61966-2-1).
fn texture_linear(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3<f32>(2.4)), c / 12.92, c <= vec3<f32>(0.04045));
}

/// The place of an index along an axis. Beyond the ends it is the last one, or on an axis that
/// wraps the one that comes round.
fn texture_index(i: i32, count: i32, wraps: bool) -> i32 {
    return select(clamp(i, 0, count - 1), (i % count + count) % count, wraps);
}

fn texture_texel(place: vec2<i32>) -> vec3<f32> {
    let size = vec2<i32>(i32(texels_at(0)), i32(texels_at(1)));
    let x = texture_index(place.x, size.x, heightmap.wrap.x == 1u);
    let y = texture_index(place.y, size.y, heightmap.wrap.y == 1u);
    return texture_linear(unpack4x8unorm(texels_at(2 + y * size.x + x)).rgb);
}

/// The colour at a place in 0..1 of a cell of the domain.
fn heightmap_paint(cell: vec2<i32>, at: vec2<f32>, height: f32, up: f32) -> vec3<f32> {
    // A sample is the middle of its texel. A box is a sample, and so is the only cell of an axis
    // with one sample.
    let alone = (heightmap.samples == vec2<i32>(1)) & (heightmap.wrap == vec2<u32>(0u));
    let middle = select(vec2<f32>(0.5), vec2<f32>(0.0), alone | vec2<bool>(HEIGHTMAP_BOXES));
    let own = vec2<f32>(heightmap_tile_cell(cell)) + at + middle;
    let size = vec2<f32>(f32(texels_at(0)), f32(texels_at(1)));
    let place = own / vec2<f32>(heightmap.samples) * size - 0.5;
    let low = vec2<i32>(floor(place));
    let f = place - floor(place);
    let first = mix(texture_texel(low), texture_texel(low + vec2<i32>(1, 0)), f.x);
    let second = mix(texture_texel(low + vec2<i32>(0, 1)), texture_texel(low + vec2<i32>(1, 1)), f.x);
    return mix(first, second, f.y);
}
