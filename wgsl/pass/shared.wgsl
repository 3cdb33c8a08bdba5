// What passes share: the mark of a hit, and the cell of an invocation.
//
// Parameters are in storage buffers. Each file copies its parameters in its `NAME_load`, which
// entry points call before any branch. There a software device reads a number once for all
// lanes. Later it would read it once per lane, which takes as long as all the arithmetic of an
// evaluation.

/// What is kept of a hit between the passes, beside its distance. Only some scenes need it.
struct Mark {
    id: u32,
    u: f32,
    v: f32,
}

/// The cell of an invocation. Tiles of 8 x 8 cells are visited in Morton order, so neighbouring
/// invocations have neighbouring cells, in groups of 8 (4 x 2) and of 32 (8 x 4).
fn tile_cell(group: vec2<u32>, lane: u32) -> vec2<u32> {
    let x = (lane & 1u) | ((lane >> 1u) & 2u) | ((lane >> 2u) & 4u);
    let y = ((lane >> 1u) & 1u) | ((lane >> 2u) & 2u) | ((lane >> 3u) & 4u);
    return group * 8u + vec2<u32>(x, y);
}
