// How wide a cone one higher place allows, in f32. Costs are only compared here; the twin
// computes ratios in f64 from the place that costs least.

/// Whether cones are over cells and leave room.
override COST_WALK: bool;
/// Units of distance in a texel.
override COST_UNITS: f32;
/// The cost at which nothing bounds a cone.
override COST_WIDEST: f32;
/// Costs that differ by more than this, relative to them, compare correctly in spite of rounding.
override COST_MARGIN: f32;
/// A rise too small to matter: it costs more than the widest, wherever it is, and its
/// square is still far from the least number.
override COST_LEAST_RISE: f32;

/// The cost of a squared distance and a rise of at least the least.
fn cost_of(squared: u32, rise: f32) -> f32 {
    if COST_WALK {
        return (sqrt(f32(squared)) + params.offset) / rise;
    }
    let units = COST_UNITS * rise;
    return f32(squared) / (units * units);
}

/// Whether something of this cost could bound the cone, as far as f32 can tell.
fn cost_matters(cost: f32) -> bool {
    return cost <= best * (1.0 + COST_MARGIN);
}
