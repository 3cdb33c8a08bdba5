// The 3 x 3 minimum of a cone map (Bán and others 2024): each cone becomes as narrow as the
// narrowest among its place and the eight around it. One invocation per ratio.
//
// Ratios are f64, which few devices have. They are not negative, so their bits are in the
// order of the ratios, and the least is found as pairs of whole numbers, to the last bit.

struct Min3x3Uniform {
    /// Places of a row, and rows of the band.
    width: u32,
    rows: u32,
    /// 1 if the horizontal axis wraps.
    wrap: u32,
    /// Ratios per place.
    channels: u32,
}

@group(0) @binding(0) var<storage, read> min3x3_parameters: Min3x3Uniform;
/// High and low word of each ratio: the band, a row before it and one after it.
@group(0) @binding(1) var<storage, read> wide: array<vec2<u32>>;
/// The band alone.
@group(0) @binding(2) var<storage, read_write> narrow: array<vec2<u32>>;
/// The parameters, copied once.
var<private> band: Min3x3Uniform;

fn min3x3_load() {
    band = min3x3_parameters;
}

/// The lesser of two ratios.
fn min3x3_least(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return select(b, a, a.x < b.x || (a.x == b.x && a.y < b.y));
}

@compute @workgroup_size(8, 8)
fn min3x3(@builtin(global_invocation_id) id: vec3<u32>) {
    min3x3_load();
    let row = band.width * band.channels;
    if id.x >= row || id.y >= band.rows {
        return;
    }
    let x = id.x / band.channels;
    let channel = id.x % band.channels;
    let last = band.width - 1u;
    // Beyond the ends the last one counts twice.
    let before = select(max(x, 1u) - 1u, (x + last) % band.width, band.wrap == 1u);
    let after = select(min(x + 1u, last), (x + 1u) % band.width, band.wrap == 1u);
    var least = wide[(id.y + 1u) * row + id.x];
    for (var y = 0u; y < 3u; y++) {
        let start = (id.y + y) * row + channel;
        least = min3x3_least(least, wide[start + before * band.channels]);
        least = min3x3_least(least, wide[start + x * band.channels]);
        least = min3x3_least(least, wide[start + after * band.channels]);
    }
    narrow[id.y * row + id.x] = least;
}
