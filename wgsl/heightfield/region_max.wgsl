// The highest point of the surface under a region. Coarse cones and empty balls are tested against
// it. `maxima` holds the levels of the pyramid of maxima one after another, fine to coarse.

/// The cells first..=end of a tiled axis as cells of one tile of `count` cells: two runs (x..=y
/// and z..=w), which are equal unless the cells lie across a seam.
fn region_runs(first: u32, end: u32, count: u32) -> vec4<u32> {
    if end - first + 1u >= count {
        return vec4<u32>(0u, count - 1u, 0u, count - 1u);
    }
    let a = first % count;
    let b = end % count;
    if a <= b {
        return vec4<u32>(a, b, a, b);
    }
    return vec4<u32>(a, count - 1u, 0u, b);
}

/// The largest apex of the cells x.x..=x.y, y.x..=y.y of one tile.
fn region_run_max(x: vec2<u32>, y: vec2<u32>) -> f32 {
    // The finest level at which the run is at most two nodes wide and high. Each level is half
    // the one below, rounded up.
    var nodes = vec4<u32>(x, y);
    var size = vec2<u32>(heightmap.cells);
    var at = 0u;
    for (var level = 0u; level < 16u; level++) {
        if nodes.y - nodes.x <= 1u && nodes.w - nodes.z <= 1u {
            break;
        }
        at += size.x * size.y;
        size = (size + 1u) / 2u;
        nodes /= 2u;
    }
    let low = at + nodes.z * size.x;
    let high = at + nodes.w * size.x;
    return max(
        max(maxima[low + nodes.x], maxima[low + nodes.y]),
        max(maxima[high + nodes.x], maxima[high + nodes.y]),
    );
}

/// The largest apex of the cells that meet the rectangle low..=high, in texels; -1 where
/// it lies outside the block.
fn region_max(low: vec2<f32>, high: vec2<f32>) -> f32 {
    let sides = vec2<f32>(heightmap.domain);
    let cells = vec2<u32>(heightmap.cells);
    if any(low > sides) || any(high < vec2<f32>(0.0)) {
        return -1.0;
    }
    let first = vec2<u32>(clamp(floor(low), vec2<f32>(0.0), sides - 1.0));
    let end = vec2<u32>(clamp(floor(high), vec2<f32>(0.0), sides - 1.0));
    let x = region_runs(first.x, end.x, cells.x);
    let y = region_runs(first.y, end.y, cells.y);
    var top = region_run_max(x.xy, y.xy);
    // Across a seam there are two runs.
    if x.x != x.z {
        top = max(top, region_run_max(x.zw, y.xy));
    }
    if y.x != y.z {
        top = max(top, region_run_max(x.xy, y.zw));
        if x.x != x.z {
            top = max(top, region_run_max(x.zw, y.zw));
        }
    }
    return top;
}
