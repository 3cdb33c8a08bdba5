// The pyramid of maxima over the apexes of a relief's cells, level after level in one
// buffer, fine to coarse. Each level halves the one below, rounding up (Tevs, Ihrke,
// Seidel 2008). Level 0 is the apexes themselves: a cell's highest point.

/// The highest point of a cell of the domain.
fn relief_apex(cell: vec2<i32>) -> f32 {
    return maxima[relief_number(cell)];
}

/// Nodes of a level along x: its cells over 2^level, rounded up.
fn maxima_width(level: u32) -> u32 {
    return (u32(relief.cells.x) + (1u << level) - 1u) >> level;
}

/// The largest apex under a node.
fn maxima_at(level: u32, node: vec2<u32>) -> f32 {
    let start = relief.starts[level >> 2u][level & 3u];
    return maxima[start + node.y * maxima_width(level) + node.x];
}
