// The tone pass: the light of a pixel as 8 bits of sRGB, in the texture that is shown. Of two bytes
// one or the other is taken from pixel to pixel.
//
// The curve of a channel is that of the files, in f64 on the host: a table holds the least radiance
// of each level, 16 to a byte. So the texture has the bytes of the file.

/// The factor of exposure, and then the least radiance that is shown as each level from 1 on.
@group(1) @binding(2) var<storage, read> tone_steps: array<f32>;
@group(2) @binding(4) var picture: texture_storage_2d<rgba8unorm, write>;

const TONE_MOST_LEVEL = 4080u;

/// The level of a radiance.
fn tone_level(x: f32) -> u32 {
    // Brighter light is white, and its square would overflow.
    let e = clamp(x * tone_steps[0], 0.0, 1e6);
    let filmic = e * (e * 2.51 + 0.03) / (e * (e * 2.43 + 0.59) + 0.14);
    let shown = min(select(e, filmic, tone_parameters.map == TONE_FILMIC), 1.0);
    let curve = select(1.055 * pow(shown, 1.0 / 2.4) - 0.055, 12.92 * shown, shown <= 0.0031308);
    // In f32 this is off by less than half a level. So the nearest step in the table decides.
    let step = clamp(u32(f32(TONE_MOST_LEVEL) * curve + 1.0), 1u, TONE_MOST_LEVEL);
    return select(step - 1u, step, x >= tone_steps[step]);
}

/// Shows the levels of a colour in a pixel.
fn tone_store(pixel: vec2<u32>, levels: vec3<u32>) {
    // The order of the pixels is that of the R2 sequence, in units of 2^-32.
    let part = (pixel.x * 0xc13fa9a9u + pixel.y * 0x91e10da6u) >> 28u;
    let bytes = (levels + part) >> vec3<u32>(4u);
    textureStore(picture, pixel, vec4<f32>(vec3<f32>(bytes) / 255.0, 1.0));
}
