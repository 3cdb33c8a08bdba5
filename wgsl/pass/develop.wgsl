// The stage after the colour pass: it shows what is coloured.

@compute @workgroup_size(64)
fn develop(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    queue_load();
    let packed = queue_tile(group.xy, lane);
    if packed == QUEUE_NONE {
        return;
    }
    let cell = queue_cell(packed);
    let index = queue_index(cell);
    var scale = turn.stage.scale;
    let ended = until_ended(index);
    // After the last sample, the sum is a mean already.
    if ended > 0.0 && scale < 1.0 {
        scale = 1.0 / ended;
    }
    let levels = tone_levels(cell_pixel(index).rgb * scale);
    tone_store(turn.stage.origin + cell, levels);
}
