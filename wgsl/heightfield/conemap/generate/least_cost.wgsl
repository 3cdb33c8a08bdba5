// Keeps the place of least cost, and marks near ties: of two places that cost the same in
// f32, f64 may prefer the other one.

/// The cost of what an earlier dispatch found.
fn cost_kept(s: SearchState) -> f32 {
    return cost_of(s.squared, s.top - apex);
}

/// Takes a place, or a node as high as its maximum, into account.
fn consider(squared: u32, top: f32, s: ptr<function, SearchState>) {
    let rise = top - apex;
    if rise < COST_LEAST_RISE {
        return;
    }
    let cost = cost_of(squared, rise);
    if !cost_matters(cost) {
        return;
    }
    // The same distance and height again is no tie: it is the same ratio.
    if squared == (*s).squared && top == (*s).top {
        return;
    }
    // Clearly cheaper than all before, whatever was nearly a tie among those.
    let clearly = cost < best * (1.0 - COST_MARGIN);
    (*s).note = select(1u, 0u, clearly);
    // A tie keeps the cheaper of the two: what comes later is compared with it.
    if cost < best {
        best = cost;
        (*s).squared = squared;
        (*s).top = top;
    }
}
