// Which places bound a cone, and how far away they are, in whole numbers: the same numbers
// as the twin's.
//
// A cone that looks to one side meets a place of a wrapping grid only at the image that lies
// on that side. A node is never farther away than a place under it, so skipping nodes by
// their distance skips no place that is near.

/// The sector: 0 is all around, 1 is a quadrant, 2 is a side.
override DISTANCE_SECTOR: u32;
/// Whether places are cells, which touch their neighbours.
override DISTANCE_OVER_CELLS: bool;

/// No place of a node counts.
const NO_DISTANCE = 0xffffffffu;

/// Steps from a place to the nearest of `low..=high` along an axis, either way.
fn distance_gap(axis: u32, place: u32, low: u32, high: u32) -> u32 {
    // Unsigned numbers: each difference is taken only where it is one.
    let ahead = max(low, place) - place;
    let back = place - min(high, place);
    let direct = max(ahead, back);
    if params.wrap[axis] == 0u || direct == 0u {
        return direct;
    }
    // Round the other way: on past the end, or back past the start.
    let count = params.size[axis];
    return min(direct, min(low + count - place, place + count - high));
}

/// The same in one direction; NO_DISTANCE if there is none.
fn distance_ahead(axis: u32, up: bool, place: u32, low: u32, high: u32) -> u32 {
    // Downward is upward in a mirror.
    let last = params.size[axis] - 1u;
    let f = select(last - place, place, up);
    let l = select(last - high, low, up);
    let h = select(last - low, high, up);
    if f <= h {
        return max(l, f) - f;
    }
    if params.wrap[axis] == 0u {
        return NO_DISTANCE;
    }
    return l + params.size[axis] - f;
}

/// Steps along and across a side's direction.
fn distance_beside(place: vec2<u32>, low: vec2<u32>, high: vec2<u32>) -> vec2<u32> {
    let axis = params.sector >> 1u;
    let other = 1u - axis;
    let up = (params.sector & 1u) == 0u;
    let along = distance_ahead(axis, up, place[axis], low[axis], high[axis]);
    let across = distance_gap(other, place[other], low[other], high[other]);
    if along == NO_DISTANCE || along >= across {
        return vec2<u32>(along, across);
    }
    let wraps = params.wrap[axis] != 0u;
    if all(low == high) {
        // The first image, turn by turn, that is within the quarter.
        let count = params.size[axis];
        let turns = (across - along + count - 1u) / count;
        return vec2<u32>(select(NO_DISTANCE, along + turns * count, wraps), across);
    }
    // Of a node at least the far end must lie within the quarter.
    let above = max(high[axis], place[axis]) - place[axis];
    let below = place[axis] - min(low[axis], place[axis]);
    let farthest = select(below, above, up);
    return vec2<u32>(select(NO_DISTANCE, across, wraps || farthest >= across), across);
}

/// The squared distance from a place to the nearest of some places that count.
fn distance_squared(place: vec2<u32>, low: vec2<u32>, high: vec2<u32>) -> u32 {
    var d = vec2<u32>(0u);
    switch DISTANCE_SECTOR {
        case 0u: {
            d.x = distance_gap(0u, place.x, low.x, high.x);
            d.y = distance_gap(1u, place.y, low.y, high.y);
        }
        case 1u: {
            // Quadrants are numbered by their lower directions: 1 for x, 2 for y.
            d.x = distance_ahead(0u, (params.sector & 1u) == 0u, place.x, low.x, high.x);
            d.y = distance_ahead(1u, (params.sector & 2u) == 0u, place.y, low.y, high.y);
        }
        default: {
            // Sides are numbered +x, -x, +y, -y.
            d = distance_beside(place, low, high);
        }
    }
    if any(d == vec2<u32>(NO_DISTANCE)) {
        return NO_DISTANCE;
    }
    // From edge to edge: one less than from centre to centre.
    if DISTANCE_OVER_CELLS {
        d = max(d, vec2<u32>(1u)) - vec2<u32>(1u);
    }
    return d.x * d.x + d.y * d.y;
}

/// Steps from a place to the nearest outside the block of a level that contains it;
/// NO_DISTANCE if there is none.
fn distance_outside(place: vec2<u32>, level: u32) -> u32 {
    var least = NO_DISTANCE;
    for (var a = 0u; a < 2u; a++) {
        // The block's ends; a border that does not wrap has no outside.
        let last = params.size[a] - 1u;
        let low = (place[a] >> level) << level;
        let high = min(low + (1u << level) - 1u, last);
        if low == 0u && high == last {
            continue;
        }
        let wraps = params.wrap[a] != 0u;
        if wraps || low > 0u {
            least = min(least, place[a] - low + 1u);
        }
        if wraps || high < last {
            least = min(least, high - place[a] + 1u);
        }
    }
    if DISTANCE_OVER_CELLS && least != NO_DISTANCE {
        least -= 1u;
    }
    return least;
}
