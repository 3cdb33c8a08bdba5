// The pyramid of maxima over the apexes of the cells of a height map, level after level in one
// buffer, fine to coarse. Each level halves the one below, rounding up (Tevs, Ihrke,
// Seidel 2008). Level 0 is the apexes themselves: a cell's highest point.
// The windows come after all levels (`maxima_cone.wgsl`).

/// The highest point of a cell of the domain.
fn heightmap_apex(cell: vec2<i32>) -> f32 {
    return maxima[heightmap_number(cell)];
}

/// Nodes of a level along x: its cells over 2^level, rounded up.
fn maxima_width(level: u32) -> u32 {
    return (u32(heightmap.cells.x) + (1u << level) - 1u) >> level;
}

/// Where the buffers of a pyramid hold a node.
fn maxima_place(level: u32, node: vec2<u32>) -> u32 {
    let start = heightmap.starts[level >> 2u][level & 3u];
    return start + node.y * maxima_width(level) + node.x;
}

/// A node over cells of the domain: its place in the buffers, and its cells low..high.
struct MaximaNode {
    at: u32,
    low: vec2<i32>,
    high: vec2<i32>,
}

/// The node of a level that a cell lies under. Each tile begins nodes of its own.
fn maxima_node(cell: vec2<i32>, level: u32) -> MaximaNode {
    let own = heightmap_tile_cell(cell);
    let tile = cell - own;
    let node = vec2<u32>(own) >> vec2<u32>(level);
    let low = vec2<i32>(node << vec2<u32>(level));
    let high = min(vec2<i32>((node + 1u) << vec2<u32>(level)), heightmap.cells);
    return MaximaNode(maxima_place(level, node), tile + low, tile + high);
}
