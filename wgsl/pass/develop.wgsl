// The stage after the colour pass: it shows what is coloured.

@group(2) @binding(3) var<storage, read> pixels: array<vec4<f32>>;

@compute @workgroup_size(64)
fn develop(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    queue_load();
    let index = queue_tile(group.x, lane);
    if index == QUEUE_NONE {
        return;
    }
    tone_store(turn.stage.origin + queue_cell(index), pixels[index].rgb);
}
