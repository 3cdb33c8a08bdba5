// Dummer's search: every place on a ring counts, by its distance and its height.

fn ring_visit(place: vec2<u32>, step: vec2<i32>, s: ptr<function, SearchState>) -> u32 {
    let squared = u32(step.x * step.x + step.y * step.y);
    consider(squared, ring_height(place, step), s);
    return 1u;
}
