// Maxima of any size as tiles: for every node of a level, the values of its four
// children side by side. One dispatch makes one level. Sizes halve rounding up, so that
// no row or column is lost, and a child that does not exist is below every height.

struct PyramidUniform {
    /// Values along each axis of the level below.
    below: vec2<u32>,
    /// Tiles along each axis of this level.
    size: vec2<u32>,
    /// Where the tiles of the level below begin, and those of this level.
    below_at: u32,
    at: u32,
    /// Whether the level below is the grid itself.
    first: u32,
    pad: u32,
}

@group(0) @binding(0) var<storage, read> pyramid_parameters: PyramidUniform;
/// The grid, row by row.
@group(0) @binding(1) var<storage, read> grid: array<f32>;
/// All levels after one another; a dispatch reads one of them and writes the next.
@group(0) @binding(2) var<storage, read_write> tiles: array<vec4<f32>>;
/// The parameters, copied once.
var<private> level: PyramidUniform;

/// Less than every height.
const PYRAMID_NONE = -1.0;

fn pyramid_load() {
    level = pyramid_parameters;
}

/// A value of the level below: of the grid, or the largest of a tile.
fn below(at: vec2<u32>) -> f32 {
    if any(at >= level.below) {
        return PYRAMID_NONE;
    }
    let index = at.y * level.below.x + at.x;
    if level.first != 0u {
        return grid[index];
    }
    let t = tiles[level.below_at + index];
    return max(max(t.x, t.y), max(t.z, t.w));
}

@compute @workgroup_size(8, 8)
fn pyramid(@builtin(global_invocation_id) id: vec3<u32>) {
    pyramid_load();
    if any(id.xy >= level.size) {
        return;
    }
    // Children are in rows: left and right of the upper one, then of the lower.
    let at = 2u * id.xy;
    tiles[level.at + id.y * level.size.x + id.x] = vec4<f32>(
        below(at),
        below(at + vec2<u32>(1u, 0u)),
        below(at + vec2<u32>(0u, 1u)),
        below(at + vec2<u32>(1u, 1u)),
    );
}
