// The pigment of a height surface by the width of a map's cones: a number for each place.

/// Whether the places are cells instead of samples.
override PAINT_OVER_CELLS: bool;

@group(0) @binding(8) var paint: texture_2d<f32>;

/// The pigment at a place in 0..1 of a cell of the domain, for the surface's height there and the
/// upward part of its normal.
fn heightmap_paint(cell: vec2<i32>, at: vec2<f32>, height: f32, up: f32) -> vec3<f32> {
    // A box has one sample, a patch one in each corner.
    let near = select(vec2<i32>(at + 0.5), vec2<i32>(0), HEIGHTMAP_BOXES);
    var place = u32(heightmap_place(heightmap_tile_cell(cell) + near));
    if PAINT_OVER_CELLS {
        place = heightmap_number(cell);
    }
    return vec3<f32>(textureLoad(paint, array_texel(place), 0).x, up, 0.5);
}
