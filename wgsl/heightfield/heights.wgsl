// A height surface: heights, the patches between them, and their tiles. The surface is the top of
// a solid block, which fills 0 <= z <= surface over a domain of `cells * tiles` cells, in texels
// and heights (docs/method.md, 4).

struct HeightmapUniform {
    samples: vec2<i32>,
    /// Cells of one tile, and of all tiles.
    cells: vec2<i32>,
    domain: vec2<i32>,
    wrap: vec2<u32>,
    /// Places of the cone map.
    places: vec2<i32>,
    /// Offset of the walk's cones, in texels.
    offset: f32,
    /// Factor on cone steps.
    scale: f32,
    levels: u32,
    /// Steps that a tracer counts itself, 0 for no such limit; the distance at which it has half
    /// of them, or at which a texel is as wide as a pixel, 0 for never; rounds of refinement.
    steps: u32,
    lod: f32,
    rounds: u32,
    /// The finest level that has windows.
    finest: u32,
    pad: array<u32, 3>,
    /// Where each level of the pyramid starts, and where its windows do.
    starts: array<vec4<u32>, 4>,
    windows: array<vec4<u32>, 4>,
}

/// Whether the patches are boxes as high as one sample, instead of bilinear between four samples.
override HEIGHTMAP_BOXES: bool;

/// Most steps read these. They are buffers, as software Vulkan reads textures more slowly.
@group(0) @binding(5) var<storage, read> heights: array<f32>;
/// One cone for each place.
@group(0) @binding(6) var<storage, read> ratios: array<f32>;
@group(0) @binding(7) var<storage, read> maxima: array<f32>;
/// The scene loads it.
var<private> heightmap: HeightmapUniform;

/// The texel of a number, in an array that is a texture, as there are more of those than storage
/// buffers: row by row, 8192 numbers to a row.
fn array_texel(i: u32) -> vec2<u32> {
    return vec2<u32>(i & 8191u, i >> 13u);
}

fn heights_at(i: i32) -> f32 {
    return heights[i];
}

/// The cell of the first tile that corresponds to a cell of the domain.
fn heightmap_tile_cell(cell: vec2<i32>) -> vec2<i32> {
    // By floats, as integers divide slowly. The quotient is at least half a cell off any integer.
    let at = max(cell, vec2<i32>(0));
    let tile = vec2<i32>((vec2<f32>(at) + 0.5) / vec2<f32>(heightmap.cells));
    return at - tile * heightmap.cells;
}

/// The number of a sample, for indices from 0 to the size. The one past the last is the first
/// again, or on an axis that does not wrap the last.
fn heightmap_place(at: vec2<i32>) -> i32 {
    let round = select(heightmap.samples - 1, vec2<i32>(0), heightmap.wrap == vec2<u32>(1u));
    let i = select(at, round, at >= heightmap.samples);
    return i.y * heightmap.samples.x + i.x;
}

/// Its height.
fn heightmap_sample(at: vec2<i32>) -> f32 {
    return heights_at(heightmap_place(at));
}

/// Corner heights of a cell of the domain: (0, 0), (1, 0), (0, 1), (1, 1).
fn heightmap_corners(cell: vec2<i32>) -> vec4<f32> {
    let c = heightmap_tile_cell(cell);
    if HEIGHTMAP_BOXES {
        return vec4<f32>(heightmap_sample(c));
    }
    return vec4<f32>(
        heightmap_sample(c),
        heightmap_sample(c + vec2<i32>(1, 0)),
        heightmap_sample(c + vec2<i32>(0, 1)),
        heightmap_sample(c + vec2<i32>(1, 1)),
    );
}

/// Height of the surface in a cell at a place in 0..1.
fn heightmap_height(cell: vec2<i32>, at: vec2<f32>) -> f32 {
    let c = heightmap_corners(cell);
    let low = c.x + at.x * (c.y - c.x);
    let high = c.z + at.x * (c.w - c.z);
    return low + at.y * (high - low);
}

/// The slope of a smooth surface through the samples, at a sample, in heights per texel.
fn heightmap_slope(at: vec2<i32>) -> vec2<f32> {
    let last = heightmap.samples - 1;
    let wraps = heightmap.wrap == vec2<u32>(1u);
    let i = select(min(at, last), select(at, vec2<i32>(0), at > last), wraps);
    let low = select(max(i - 1, vec2<i32>(0)), select(i - 1, last, i == vec2<i32>(0)), wraps);
    let high = select(min(i + 1, last), i + 1, wraps);
    let span = select(max(high - low, vec2<i32>(1)), vec2<i32>(2), wraps);
    let rise = vec2<f32>(
        heightmap_sample(vec2<i32>(high.x, i.y)) - heightmap_sample(vec2<i32>(low.x, i.y)),
        heightmap_sample(vec2<i32>(i.x, high.y)) - heightmap_sample(vec2<i32>(i.x, low.y)),
    );
    return rise / vec2<f32>(span);
}

/// The slope in a cell of the domain at a place in 0..1, bilinear between those of the samples.
fn heightmap_smooth_slope(cell: vec2<i32>, at: vec2<f32>) -> vec2<f32> {
    let c = heightmap_tile_cell(cell);
    let low = mix(heightmap_slope(c), heightmap_slope(c + vec2<i32>(1, 0)), at.x);
    let high = mix(heightmap_slope(c + vec2<i32>(0, 1)), heightmap_slope(c + vec2<i32>(1, 1)), at.x);
    return mix(low, high, at.y);
}

/// The number of a cell within its tile, row by row.
fn heightmap_number(cell: vec2<i32>) -> u32 {
    let c = heightmap_tile_cell(cell);
    return u32(c.y * heightmap.cells.x + c.x);
}
