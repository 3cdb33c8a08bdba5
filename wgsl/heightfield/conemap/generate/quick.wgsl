// Quick cone maps: the eight neighbours of a place's node at every level of the maxima.
// Together they cover everything, and the rule says how near each is taken to be.
//
// Rectangles are on the unrolled plane, where a neighbour across a wrapping border has
// indices below 0 or beyond the last. Distances to them are the shortest on the wrapping
// grid, because another image of the same places may be nearer.

/// 0: naive, at the nearest point; 1: improved, at the nearest point that no finer level
/// has seen; 2: at the centre.
override QUICK_RULE: u32;

/// Maxima by tiles, as numbers: a node's lies in the tile of its parent.
@group(0) @binding(2) var<storage, read> tiles: array<f32>;

/// An interval that is empty, or everything: far beyond all indices.
const QUICK_FAR = 0x40000000i;

/// What a node of a level covers along an axis, by its index on the unrolled plane.
struct QuickNode {
    /// Its index on the grid.
    own: u32,
    low: i32,
    high: i32,
    exists: bool,
}

fn quick_node(axis: u32, level: u32, index: i32) -> QuickNode {
    let n = i32(params.size[axis]);
    let nodes = ((n - 1) >> level) + 1;
    var own = index;
    var turned = 0;
    // Neighbours are at most one turn away.
    if index < 0 {
        own += nodes;
        turned = -n;
    }
    if index >= nodes {
        own -= nodes;
        turned = n;
    }
    let low = own << level;
    let high = min(low + (1 << level) - 1, n - 1);
    let exists = turned == 0 || params.wrap[axis] != 0u;
    return QuickNode(u32(own), low + turned, high + turned, exists);
}

/// Steps from a place to the nearest image of an interval.
fn quick_gap(axis: u32, place: u32, low: i32, high: i32) -> u32 {
    let p = i32(place);
    let direct = max(max(low - p, p - high), 0);
    if params.wrap[axis] == 0u {
        return u32(direct);
    }
    // The interval's images one turn on and one turn back.
    let n = i32(params.size[axis]);
    let ahead = max(max(low - p - n, p + n - high), 0);
    let back = max(max(low - p + n, p - n - high), 0);
    return u32(min(direct, min(ahead, back)));
}

/// The squared distance to a rectangle of the unrolled plane, or to nothing if it is empty.
fn quick_squared(place: vec2<u32>, low: vec2<i32>, high: vec2<i32>) -> u32 {
    if any(low > high) {
        return 0xffffffffu;
    }
    let x = quick_gap(0u, place.x, low.x, high.x);
    let y = quick_gap(1u, place.y, low.y, high.y);
    return x * x + y * y;
}

/// The nearest part of a node outside of what was seen: that is left, right, above and
/// below of it, and no fifth.
fn quick_unseen(place: vec2<u32>, low: vec2<i32>, high: vec2<i32>, seen: vec4<i32>) -> u32 {
    let left = quick_squared(place, low, vec2<i32>(min(high.x, seen.x - 1), high.y));
    let right = quick_squared(place, vec2<i32>(max(low.x, seen.z + 1), low.y), high);
    let above = quick_squared(place, low, vec2<i32>(high.x, min(high.y, seen.y - 1)));
    let below = quick_squared(place, vec2<i32>(low.x, max(low.y, seen.w + 1)), high);
    return min(min(left, right), min(above, below));
}

/// Twice the distance along an axis to the centre of an interval.
fn quick_to_center(axis: u32, place: u32, low: i32, high: i32) -> u32 {
    let twice = abs(low + high - 2 * i32(place));
    if params.wrap[axis] == 0u {
        return u32(twice);
    }
    // The shorter way round.
    let round = 2 * i32(params.size[axis]);
    let rest = twice % round;
    return u32(min(rest, round - rest));
}

/// Four times the squared distance at which a neighbour counts, `step` nodes away.
fn quick_quarters(place: vec2<u32>, x: QuickNode, y: QuickNode, step: vec2<i32>, seen: vec4<i32>) -> u32 {
    // First and last place of the neighbour.
    let low = vec2<i32>(x.low, y.low);
    let high = vec2<i32>(x.high, y.high);
    if QUICK_RULE == 2u {
        // Straight ahead only the one axis counts.
        let dx = select(quick_to_center(0u, place.x, x.low, x.high), 0u, step.x == 0);
        let dy = select(quick_to_center(1u, place.y, y.low, y.high), 0u, step.y == 0);
        return dx * dx + dy * dy;
    }
    var squared = 0u;
    if QUICK_RULE == 1u {
        squared = quick_unseen(place, low, high, seen);
    } else {
        squared = quick_squared(place, low, high);
    }
    return select(4u * squared, 0xffffffffu, squared == 0xffffffffu);
}

/// What three nodes in a row cover along an axis: first and last.
fn quick_block(axis: u32, before: QuickNode, own: QuickNode, after: QuickNode) -> vec2<i32> {
    let low = select(own.low, before.low, before.exists);
    let high = select(own.high, after.high, after.exists);
    if params.wrap[axis] != 0u && high - low + 1 >= i32(params.size[axis]) {
        // All round: nothing along this axis is new.
        return vec2<i32>(-QUICK_FAR, QUICK_FAR);
    }
    return vec2<i32>(low, high);
}

/// All neighbours of all levels at once: at most 8 times 13, less than a dispatch's.
fn work(place: vec2<u32>, s: ptr<function, SearchState>) {
    // Seen before: only the place itself. First corner, then last.
    var seen = vec4<i32>(vec2<i32>(place), vec2<i32>(place));
    for (var level = 0u; level < params.levels; level++) {
        let own = vec2<i32>(place >> vec2<u32>(level));
        // A node's maximum lies in the tile of its parent.
        let above = level + 1u;
        let width = ((params.size.x - 1u) >> above) + 1u;
        let at = params.at[above >> 2u][above & 3u];
        var xs = array<QuickNode, 3>(
            quick_node(0u, level, own.x - 1),
            quick_node(0u, level, own.x),
            quick_node(0u, level, own.x + 1),
        );
        // What the block of 3 x 3 covers, for the next level to leave out.
        let block_x = quick_block(0u, xs[0], xs[1], xs[2]);
        let before = quick_node(1u, level, own.y - 1);
        let here = quick_node(1u, level, own.y);
        let after = quick_node(1u, level, own.y + 1);
        let block_y = quick_block(1u, before, here, after);
        for (var j = 0; j < 3; j++) {
            let y = quick_node(1u, level, own.y + j - 1);
            for (var i = 0; i < 3; i++) {
                let x = xs[i];
                // Across a border that wraps a node may be its own neighbour.
                let itself = x.own == u32(own.x) && y.own == u32(own.y);
                if !x.exists || !y.exists || itself {
                    continue;
                }
                let tile = at + (y.own >> 1u) * width + (x.own >> 1u);
                let top = tiles[4u * tile + 2u * (y.own & 1u) + (x.own & 1u)];
                // Not higher: it need not be located.
                if top - apex < COST_LEAST_RISE {
                    continue;
                }
                let quarters = quick_quarters(place, x, y, vec2<i32>(i - 1, j - 1), seen);
                if quarters != 0xffffffffu {
                    consider(quarters, top, s);
                }
            }
        }
        seen = vec4<i32>(block_x.x, block_y.x, block_x.y, block_y.y);
    }
    (*s).stage = SEARCH_DONE;
}
