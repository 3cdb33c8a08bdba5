// Relaxed cones by a search along rays (Listing 18-2 of Policarpo and Oliveira). What
// is kept of an exit is the sample that the ray entered at and the step at which it came
// out. In f32 that is now and then a step more or less, which the unsound rule tolerates.

/// Height at which rays start, a little above the top.
override RELAXED_START: f32;

/// The cost of an exit: how far the ray has come, and how high it still is.
fn exit_cost(squared: u32, entry: f32, step: u32) -> f32 {
    let part = f32(step) / f32(params.steps);
    let far = 1.0 + part * entry / (RELAXED_START - entry);
    // Rays end at the bottom with the last step.
    let rise = entry * (1.0 - part) - apex;
    if rise < COST_LEAST_RISE {
        return COST_WIDEST;
    }
    return f32(squared) * far * far / (rise * rise);
}

/// The cost of what an earlier dispatch found.
fn cost_kept(s: SearchState) -> f32 {
    return exit_cost(s.squared, s.top, s.note);
}

/// The sample at an index of the unrolled plane. A nearly flat ray leads a thousand times
/// as far as its samples are apart: still whole numbers of 32 bits.
fn sample(index: vec2<i32>) -> f32 {
    let n = vec2<i32>(params.size);
    let ends = clamp(index, vec2<i32>(0), n - 1);
    let round = ((index % n) + n) % n;
    let at = vec2<u32>(select(ends, round, params.wrap != vec2<u32>(0u)));
    return heights[at.y * params.size.x + at.x];
}

/// The bilinear surface.
fn surface_height(p: vec2<f32>) -> f32 {
    let cell = floor(p);
    let f = p - cell;
    let i = vec2<i32>(cell);
    let upper = mix(sample(i), sample(i + vec2<i32>(1, 0)), f.x);
    let lower = mix(sample(i + vec2<i32>(0, 1)), sample(i + vec2<i32>(1, 1)), f.x);
    return mix(upper, lower, f.y);
}

/// Follows the ray through a sample to where it comes out. Each step counts as four
/// rounds, one per sample read.
fn ring_visit(place: vec2<u32>, step: vec2<i32>, s: ptr<function, SearchState>) -> u32 {
    let entry = ring_height(place, step);
    let rise = entry - apex;
    let squared = u32(step.x * step.x + step.y * step.y);
    // The exit lies farther and lower than the entry.
    if rise < COST_LEAST_RISE || cost_of(squared, rise) >= best {
        return 1u;
    }
    let start = vec2<f32>(place);
    let way = vec2<f32>(step);
    // Distance to the ray's end at the bottom, in distances of the two samples.
    let reach = entry / (RELAXED_START - entry);
    var k = 1u;
    for (; k < params.steps; k++) {
        let part = f32(k) / f32(params.steps);
        let z = entry * (1.0 - part);
        // Wherever it comes out now, it is no higher than the apex.
        if z <= apex {
            break;
        }
        // Out again: the surface lies lower than the ray.
        if surface_height(start + way * (1.0 + reach * part)) < z {
            let cost = exit_cost(squared, entry, k);
            if cost < best {
                best = cost;
                (*s).squared = squared;
                (*s).top = entry;
                (*s).note = k;
            }
            break;
        }
    }
    return 4u * k;
}
