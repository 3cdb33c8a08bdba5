// Slopes at the samples: rise per texel by central differences, at a border that does not
// wrap by the difference to the one neighbour that there is. One invocation per sample.

struct SlopesUniform {
    /// Samples along each axis.
    size: vec2<u32>,
    /// 1 for each axis that wraps.
    wrap: vec2<u32>,
    /// First row of the band, and its rows.
    first: u32,
    rows: u32,
    pad0: u32,
    pad1: u32,
}

@group(0) @binding(0) var<storage, read> slopes_parameters: SlopesUniform;
/// Heights of the band, of the row before it and of the one after it.
@group(0) @binding(1) var<storage, read> near: array<f32>;
/// The slopes along x and y of the band.
@group(0) @binding(2) var<storage, read_write> found: array<vec2<f32>>;
/// The parameters, copied once.
var<private> band: SlopesUniform;

fn slopes_load() {
    band = slopes_parameters;
}

@compute @workgroup_size(8, 8)
fn slopes(@builtin(global_invocation_id) id: vec3<u32>) {
    slopes_load();
    let width = band.size.x;
    if id.x >= width || id.y >= band.rows {
        return;
    }
    let last = band.size - 1u;
    let place = vec2<u32>(id.x, band.first + id.y);
    // Beyond the ends stands the sample itself, one step off.
    let before = select(max(id.x, 1u) - 1u, (id.x + last.x) % width, band.wrap.x == 1u);
    let after = select(min(id.x + 1u, last.x), (id.x + 1u) % width, band.wrap.x == 1u);
    let row = (id.y + 1u) * width;
    let low = vec2<f32>(near[row + before], near[row - width + id.x]);
    let high = vec2<f32>(near[row + after], near[row + width + id.x]);
    let inside = (band.wrap == vec2<u32>(1u)) | ((place > vec2<u32>(0u)) & (place < last));
    let per_step = select(vec2<f32>(1.0), vec2<f32>(0.5), inside);
    found[id.y * width + id.x] = (high - low) * per_step;
}
