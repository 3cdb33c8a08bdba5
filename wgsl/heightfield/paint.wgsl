// A relief painted by a number for each place of a cone map: how wide its cones are.

/// Whether the places are cells, in place of samples.
override PAINT_OVER_CELLS: bool;

@group(0) @binding(8) var<storage, read> paint: array<f32>;

/// What picks the hue at a place in 0..1 of a cell of the domain, of a surface so high.
fn relief_paint(cell: vec2<i32>, at: vec2<f32>, height: f32) -> f32 {
    if PAINT_OVER_CELLS {
        return paint[relief_number(cell)];
    }
    // A box has one sample, a patch one in each corner.
    let near = select(vec2<i32>(at + 0.5), vec2<i32>(0), RELIEF_BOXES);
    return paint[relief_place(relief_tile_cell(cell) + near)];
}
