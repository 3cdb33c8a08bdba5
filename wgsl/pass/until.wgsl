// Tiles that end before they have all samples: what `judge.wgsl` has decided.

/// The samples of a pixel that has ended; 0 if it goes on.
fn until_ended(index: u32) -> f32 {
    if turn.stage.before == 0u {
        return 0.0;
    }
    return bitcast<f32>(cells.words[turn.stage.halves + 4u * index + 3u]);
}

/// Lets a pixel go on.
fn until_begin(index: u32) {
    cells.words[turn.stage.halves + 4u * index + 3u] = 0u;
}
