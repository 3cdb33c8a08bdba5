// All places around one, in growing square rings. Another module says what is done with a
// place: `ring_visit`, which returns how many rounds it took.
//
// Each place is visited once, at its nearest image where axes wrap, so that no corner
// beyond two borders is missed. The search ends at a ring if a place on it, as high as the
// highest of all, would not narrow the cone. This rule is in texels and holds for any aspect.

/// The least and the greatest step from a place along an axis.
fn ring_span(axis: u32, place: u32) -> vec2<i32> {
    let n = i32(params.size[axis]);
    if params.wrap[axis] != 0u {
        return vec2<i32>(-(n / 2), (n - 1) / 2);
    }
    return vec2<i32>(-i32(place), n - 1 - i32(place));
}

/// Visits rings until none can matter, or until the rounds are used up.
fn work(place: vec2<u32>, s: ptr<function, SearchState>) {
    let x = ring_span(0u, place.x);
    let y = ring_span(1u, place.y);
    let last = max(max(-x.x, x.y), max(-y.x, y.y));
    let most = params.top - apex;
    // Rounds left in this dispatch. The next dispatch continues where they end.
    var left = params.rounds;
    // It continues at this ring, this side of it, and this step along the side.
    var ring = max(i32((*s).stage), 1);
    var side = (*s).node_x;
    var done = i32((*s).pending_low);
    loop {
        if ring > last || most < COST_LEAST_RISE
            || !cost_matters(cost_of(u32(ring * ring), most)) {
            (*s).stage = SEARCH_DONE;
            return;
        }
        // Two rows with their corners, then two columns without.
        while side < 4u {
            let rows = side < 2u;
            // The step across the side, and the steps along it that the grid has.
            let across = select(-ring, ring, (side & 1u) != 0u);
            let span = select(y, x, rows);
            let other = select(x, y, rows);
            let reach = select(ring - 1, ring, rows);
            if across >= other.x && across <= other.y {
                let end = min(span.y, reach);
                for (var i = max(span.x, -reach) + done; i <= end; i++) {
                    if left == 0u {
                        (*s).stage = u32(ring);
                        (*s).node_x = side;
                        (*s).pending_low = u32(i - max(span.x, -reach));
                        return;
                    }
                    let step = select(vec2<i32>(across, i), vec2<i32>(i, across), rows);
                    left -= min(left, ring_visit(place, step, s));
                }
            }
            side += 1u;
            done = 0;
        }
        side = 0u;
        ring += 1;
    }
}

/// The height at some steps from a place, at most one turn away.
fn ring_height(place: vec2<u32>, step: vec2<i32>) -> f32 {
    // One turn more keeps the remainder from being that of a negative number.
    let n = vec2<i32>(params.size);
    let at = (vec2<i32>(place) + step + n) % n;
    return heights[u32(at.y) * params.size.x + u32(at.x)];
}
