// From light to display values where channels are mixed: white balance, saturation, and the tone
// maps that are no curves of a single channel. In f32 a few bytes in 100 000 differ from the file's.

struct ToneUniform {
    /// Rows of white balance and saturation.
    red: vec3<f32>,
    /// The map: a word of `TONE_...`.
    map: u32,
    green: vec3<f32>,
    /// 1 if channels are mixed.
    mixes: u32,
    blue: vec3<f32>,
    /// The factor of exposure, if channels are mixed.
    exposure: f32,
}

@group(1) @binding(3) var<storage, read> tone_parameters: ToneUniform;

const TONE_FILMIC = 0u;
const TONE_AGX = 1u;
const TONE_PUNCHY = 2u;
const TONE_NEUTRAL = 3u;
const TONE_ACES = 4u;

const TONE_MOST_LIGHT = 1e6;
const TONE_LUMA = vec3<f32>(0.2126, 0.7152, 0.0722);
const TONE_AGX_IN = mat3x3<f32>(
    0.842479062, 0.042328242, 0.042375655,
    0.078433600, 0.878468636, 0.078433600,
    0.079223745, 0.079166127, 0.879142974,
);
const TONE_AGX_OUT = mat3x3<f32>(
    1.196879005, -0.052896852, -0.052971636,
    -0.098020881, 1.151903130, -0.098043450,
    -0.099029744, -0.098961177, 1.151073673,
);
const TONE_ACES_IN = mat3x3<f32>(
    0.59719, 0.07600, 0.02840,
    0.35458, 0.90834, 0.13383,
    0.04823, 0.01566, 0.83777,
);
const TONE_ACES_OUT = mat3x3<f32>(
    1.60475, -0.10208, -0.00327,
    -0.53108, 1.10813, -0.07276,
    -0.07367, -0.00605, 1.07602,
);

/// Levels of a display value.
fn tone_encoded(shown: vec3<f32>) -> vec3<u32> {
    let x = clamp(shown, vec3<f32>(0.0), vec3<f32>(1.0));
    return vec3<u32>(f32(TONE_MOST_LEVEL) * x + 0.5);
}

/// Levels of radiance, each by its own channel.
fn tone_channels(c: vec3<f32>) -> vec3<u32> {
    return vec3<u32>(tone_level(c.r), tone_level(c.g), tone_level(c.b));
}

/// The binary logarithm. That of some drivers is too coarse for levels.
fn tone_log2(v: vec3<f32>) -> vec3<f32> {
    let bits = bitcast<vec3<u32>>(max(v, vec3<f32>(1e-10)));
    // The mantissa from about 0.7 to 1.4, and the power of two that it lacks.
    let power = (bitcast<vec3<i32>>(bits) - 0x3f3504f3) >> vec3<u32>(23u);
    let m = bitcast<vec3<f32>>(bitcast<vec3<i32>>(bits) - (power << vec3<u32>(23u)));
    // 2 atanh(s) / ln 2, whose next term is below 1e-9.
    let s = (m - 1.0) / (m + 1.0);
    let q = s * s;
    let series = 1.0 + q * (0.33333333 + q * (0.2 + q * (0.14285714 + q * 0.11111111)));
    return vec3<f32>(power) + s * 2.8853901 * series;
}

/// The curve of AgX after its rotation.
fn tone_agx_curve(v: vec3<f32>) -> vec3<f32> {
    let x = (tone_log2(TONE_AGX_IN * v) + 12.47393) / 16.5;
    // The twin's polynomial about 0.5, where its terms do not cancel.
    let y = clamp(x, vec3<f32>(0.0), vec3<f32>(1.0)) - 0.5;
    let high = ((15.5 * y + 6.36) * y - 10.265) * y - 4.548;
    return ((high * y + 2.42405) * y + 1.7404) * y + 0.2914925;
}

/// AgX with more contrast.
fn tone_punchy(curve: vec3<f32>) -> vec3<f32> {
    let x = pow(max(curve, vec3<f32>(0.0)), vec3<f32>(1.35));
    let grey = dot(x, TONE_LUMA);
    return grey + 1.4 * (x - grey);
}

fn tone_neutral(c: vec3<f32>) -> vec3<f32> {
    let low = min(c.r, min(c.g, c.b));
    let v = c - select(0.04, low - 6.25 * low * low, low < 0.08);
    let peak = max(v.r, max(v.g, v.b));
    if peak < 0.76 {
        return v;
    }
    let shown = 1.0 - 0.0576 / (peak - 0.52);
    let white = 1.0 - 1.0 / (0.15 * (peak - shown) + 1.0);
    return mix(v * (shown / peak), vec3<f32>(shown), white);
}

fn tone_aces(c: vec3<f32>) -> vec3<f32> {
    let v = TONE_ACES_IN * c;
    let one = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432951) + 0.238081);
    return TONE_ACES_OUT * one;
}

/// The level of each channel of a pixel's light. Some drivers evaluate all cases, so they share what
/// they can.
fn tone_levels(c: vec3<f32>) -> vec3<u32> {
    let most = vec3<f32>(TONE_MOST_LIGHT);
    let light = clamp(c * tone_parameters.exposure, vec3<f32>(0.0), most);
    let balanced = vec3<f32>(
        dot(tone_parameters.red, light),
        dot(tone_parameters.green, light),
        dot(tone_parameters.blue, light),
    );
    var v = select(c, clamp(balanced, vec3<f32>(0.0), most), tone_parameters.mixes > 0u);
    let map = tone_parameters.map;
    if map == TONE_AGX || map == TONE_PUNCHY {
        let curve = tone_agx_curve(v);
        return tone_encoded(TONE_AGX_OUT * select(curve, tone_punchy(curve), map == TONE_PUNCHY));
    }
    if map == TONE_NEUTRAL {
        v = tone_neutral(v);
    } else if map == TONE_ACES {
        v = tone_aces(v);
    }
    return tone_channels(v);
}
