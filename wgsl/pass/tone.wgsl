// The tone pass: the light of a pixel as 8 bits of sRGB, in the texture that is shown.
//
// The curve is that of the files, in f64 on the host: a table holds the least radiance of each
// byte. So the texture has the bytes of the file.

/// The factor of exposure, and then the least radiance that is shown as each byte from 1 to 255.
@group(1) @binding(2) var<storage, read> tone_steps: array<f32, 256>;
@group(2) @binding(4) var picture: texture_storage_2d<rgba8unorm, write>;

/// The byte of a radiance, over 255.
fn tone_byte(x: f32) -> f32 {
    // Brighter light is white, and its square would overflow.
    let e = clamp(x * tone_steps[0], 0.0, 1e6);
    let shown = min(e * (e * 2.51 + 0.03) / (e * (e * 2.43 + 0.59) + 0.14), 1.0);
    let curve = select(1.055 * pow(shown, 1.0 / 2.4) - 0.055, 12.92 * shown, shown <= 0.0031308);
    var byte = u32(255.0 * curve + 0.5);
    // In f32 the byte is off by one at most. The table decides.
    if byte < 255u && x >= tone_steps[byte + 1u] {
        byte += 1u;
    } else if byte > 0u && x < tone_steps[byte] {
        byte -= 1u;
    }
    return f32(byte) / 255.0;
}

fn tone_store(pixel: vec2<u32>, c: vec3<f32>) {
    let shown = vec4<f32>(tone_byte(c.r), tone_byte(c.g), tone_byte(c.b), 1.0);
    textureStore(picture, pixel, shown);
}
