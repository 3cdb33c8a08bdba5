// A transparent background: no sky is added, and hits are counted.
//
// The fourth number of a pixel's light is one more than the hits of its samples, and below zero if a
// shadow is a guess. 65 536 samples fit an f32.

/// What a sample without a hit adds.
fn background(sky: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(0.0);
}

/// The fourth number of a sample.
fn background_note(decided: f32, is_hit: bool) -> f32 {
    let n = select(1.0, 2.0, is_hit);
    return select(-n, n, decided > 0.0);
}

/// The fourth numbers of the samples before and of one more, which may not count.
fn background_join(sum: f32, own: f32, counts: bool) -> f32 {
    let n = abs(sum) + select(0.0, abs(own) - 1.0, counts);
    return select(-n, n, sum > 0.0 && own > 0.0);
}

/// The hits of a fourth number.
fn background_hits(note: f32) -> f32 {
    return abs(note) - 1.0;
}
