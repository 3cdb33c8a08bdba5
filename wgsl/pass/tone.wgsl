// The tone pass: the light of a pixel as 8 bits of sRGB, in the texture that is shown.
//
// The curve is that of the files, in f64 on the host: a table holds the least radiance of each
// byte. So the texture has the bytes of the file.

/// The least radiance that is shown as each byte from 1 to 255; the first is unused.
@group(1) @binding(2) var<storage, read> tone_steps: array<f32, 256>;
@group(2) @binding(4) var picture: texture_storage_2d<rgba8unorm, write>;

/// The byte of a radiance, over 255.
fn tone_byte(x: f32) -> f32 {
    var low = 0u;
    // The last step that is at most x, in 8 halvings.
    for (var bit = 128u; bit > 0u; bit /= 2u) {
        if x >= tone_steps[low + bit] {
            low += bit;
        }
    }
    return f32(low) / 255.0;
}

fn tone_store(pixel: vec2<u32>, c: vec3<f32>) {
    let shown = vec4<f32>(tone_byte(c.r), tone_byte(c.g), tone_byte(c.b), 1.0);
    textureStore(picture, pixel, shown);
}
