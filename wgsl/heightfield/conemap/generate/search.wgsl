// The least cost of all places by branch and bound over the maxima.
//
// The pyramid is stored as tiles: the maxima of a node's four children side by side, so
// that one read decides about all four. Which of them are still to be visited is four
// bits per level, in the order of their distance; with them the walk needs no stack.
// The lowest bit that is set is the next node: the deepest level comes first, and on it
// the nearest.

/// Maxima of the children of every node, levels one after another; below 0 where there
/// is no child.
@group(0) @binding(2) var<storage, read> tiles: array<vec4<f32>>;

/// Which child of a node lies on the place's side: 1 for the right one, 2 for the lower.
fn side_of(place: vec2<u32>, node: vec2<u32>, level: u32) -> u32 {
    let middle = (2u * node + 1u) << vec2<u32>(level - 1u);
    return select(0u, 1u, place.x >= middle.x) | select(0u, 2u, place.y >= middle.y);
}

/// Renumbers a mask of children by their distance: child i becomes i ^ side.
fn by_distance(mask: u32, side: u32) -> u32 {
    var m = mask;
    if (side & 1u) != 0u {
        m = ((m & 5u) << 1u) | ((m >> 1u) & 5u);
    }
    if (side & 2u) != 0u {
        m = ((m & 3u) << 2u) | (m >> 2u);
    }
    return m;
}

/// Looks at the four children of a node. Places are taken into account at once; of nodes
/// those worth a visit are returned, one bit each.
fn examine(place: vec2<u32>, node: vec2<u32>, level: u32, s: ptr<function, SearchState>) -> u32 {
    let width = ((params.size.x - 1u) >> level) + 1u;
    let tops = tiles[params.at[level >> 2u][level & 3u] + node.y * width + node.x];
    let rises = tops - apex;
    // Above every child's maximum, or beyond the grid: most tiles end here.
    if all(rises < vec4<f32>(COST_LEAST_RISE)) {
        return 0u;
    }
    // Places from and to which the two columns and rows of children reach.
    let half = 1u << (level - 1u);
    let low = node << vec2<u32>(level);
    let last = params.size - 1u;
    let end = low + half - 1u;
    let next = low + half;
    let high = min(end + half, last);
    // The last nodes of a level may reach beyond the grid.
    let squared = vec4<u32>(
        distance_squared(place, low, min(end, last)),
        distance_squared(place, vec2<u32>(next.x, low.y), vec2<u32>(high.x, min(end.y, last.y))),
        distance_squared(place, vec2<u32>(low.x, next.y), vec2<u32>(min(end.x, last.x), high.y)),
        distance_squared(place, next, high),
    );
    var mask = 0u;
    for (var i = 0u; i < 4u; i++) {
        if rises[i] >= COST_LEAST_RISE && squared[i] != NO_DISTANCE {
            if cost_matters(cost_of(squared[i], rises[i])) {
                mask |= 1u << i;
            }
        }
    }
    // Children of the lowest tiles are places, each at its own distance.
    if level > 1u || mask == 0u {
        return mask;
    }
    for (var i = 0u; i < 4u; i++) {
        if (mask & (1u << i)) != 0u {
            consider(squared[i], tops[i], s);
        }
    }
    return 0u;
}

/// The tile beside the place's own on the side where its nearer neighbours are; its own
/// where there is none.
fn tile_beside(axis: u32, place: u32) -> u32 {
    let own = place >> 1u;
    let last = (params.size[axis] - 1u) >> 1u;
    let wraps = params.wrap[axis] != 0u;
    // Odd places have the next tile's as neighbours, even ones the previous tile's.
    if (place & 1u) != 0u {
        if own < last {
            return own + 1u;
        }
        return select(own, 0u, wraps);
    }
    if own > 0u {
        return own - 1u;
    }
    return select(own, last, wraps);
}

/// Searches on until the end, or until its rounds are used up.
fn work(place: vec2<u32>, s: ptr<function, SearchState>) {
    // The level up to whose ancestor everything is done, and the node looked at last.
    var climbed = (*s).stage & 31u;
    var level = (*s).stage >> 5u;
    var node = vec2<u32>((*s).node_x, (*s).node_y);
    var low = (*s).pending_low;
    var high = (*s).pending_high;
    // Over the highest place of all nothing bounds the cone.
    let most = params.top - apex;
    if most < COST_LEAST_RISE {
        (*s).stage = SEARCH_DONE;
        return;
    }
    if climbed == 0u {
        // The four tiles that hold the eight neighbours: a good first guess.
        let own = place >> vec2<u32>(1u);
        let other = vec2<u32>(tile_beside(0u, place.x), tile_beside(1u, place.y));
        for (var i = 0u; i < 4u; i++) {
            let at = select(own, other, vec2<bool>((i & 1u) != 0u, (i & 2u) != 0u));
            examine(place, at, 1u, s);
        }
        climbed = 1u;
        level = 1u;
    }
    for (var round = 0u; round < params.rounds; round++) {
        var skip = 0u;
        if (low | high) == 0u {
            // Nothing is left below: climb, if anything above can matter.
            let steps = distance_outside(place, climbed);
            if climbed >= params.levels || steps == NO_DISTANCE
                || !cost_matters(cost_of(steps * steps, most)) {
                (*s).stage = SEARCH_DONE;
                return;
            }
            climbed += 1u;
            level = climbed;
            node = place >> vec2<u32>(level);
            // The place's own side is done.
            skip = 1u;
        } else {
            // Four bits per level from the second; a deeper level is a lower one.
            var bit = firstTrailingBit(low);
            if low == 0u {
                bit = 32u + firstTrailingBit(high);
                high &= high - 1u;
            } else {
                low &= low - 1u;
            }
            // The node whose child this is: an ancestor of the last one, or that itself.
            let above = 2u + (bit >> 2u);
            node = node >> vec2<u32>(above - level);
            let child = (bit & 3u) ^ side_of(place, node, above);
            node = 2u * node + vec2<u32>(child & 1u, child >> 1u);
            level = above - 1u;
        }
        let found = examine(place, node, level, s);
        if found != 0u {
            let mask = by_distance(found, side_of(place, node, level)) & ~skip;
            let shift = 4u * (level - 2u);
            if shift < 32u {
                low |= mask << shift;
            } else {
                high |= mask << (shift - 32u);
            }
        }
    }
    // Out of rounds: the next dispatch goes on from here.
    (*s).stage = climbed | (level << 5u);
    (*s).node_x = node.x;
    (*s).node_y = node.y;
    (*s).pending_low = low;
    (*s).pending_high = high;
}
