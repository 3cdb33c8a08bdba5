// The stage that ends the samples of tiles: see `src/pass/until.rs`. A workgroup judges a tile of
// 64 x 64 pixels, and each of its invocations a column of it.
//
// Of each pixel, four words are kept: the sum of the light when it was judged last, and the number of
// samples once it has ended.

/// Squared errors of the columns, in levels, and their pixels.
var<workgroup> judged: array<vec2<f32>, 64>;

/// Where the half of a pixel is kept.
fn judge_at(cell: vec2<u32>) -> u32 {
    return turn.stage.halves + 4u * queue_index(cell);
}

/// The squared error of a pixel, summed over its channels.
fn judge_pixel(cell: vec2<u32>, share: f32) -> f32 {
    let at = judge_at(cell);
    let kept = vec3<u32>(cells.words[at], cells.words[at + 1u], cells.words[at + 2u]);
    let half = bitcast<vec3<f32>>(kept);
    let rest = cell_pixel(queue_index(cell)).rgb - half;
    let off = vec3<f32>(tone_levels(half * share)) - vec3<f32>(tone_levels(rest * share));
    return 0.25 * dot(off, off);
}

@compute @workgroup_size(64)
fn judge(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    queue_load();
    let tile = queue_divide(queue_group(group.xy), (turn.stage.cells.x + 63u) / 64u);
    let corner = 64u * tile;
    let samples = f32(turn.stage.before + 1u);
    let x = corner.x + lane;
    // No pixel of a tile beyond the block, or of one that has ended, is looked at.
    var end = min(corner.y + 64u, turn.stage.cells.y);
    if x >= turn.stage.cells.x || corner.y >= end {
        end = corner.y;
    } else if bitcast<f32>(cells.words[judge_at(corner) + 3u]) > 0.0 {
        end = corner.y;
    }
    var sum = vec2<f32>(0.0);
    if turn.stage.until >= 0.0 {
        for (var y = corner.y; y < end; y++) {
            sum += vec2<f32>(judge_pixel(vec2<u32>(x, y), 2.0 / samples), 3.0);
        }
    }
    judged[lane] = sum;
    workgroupBarrier();
    // All add up in the same order.
    var all = vec2<f32>(0.0);
    for (var i = 0u; i < 64u; i++) {
        all += judged[i];
    }
    let ends = turn.stage.until >= 0.0 && all.x < turn.stage.until * all.y;
    for (var y = corner.y; y < end; y++) {
        let at = judge_at(vec2<u32>(x, y));
        let light = bitcast<vec3<u32>>(cell_pixel(queue_index(vec2<u32>(x, y))).rgb);
        cells.words[at] = light.x;
        cells.words[at + 1u] = light.y;
        cells.words[at + 2u] = light.z;
        cells.words[at + 3u] = bitcast<u32>(select(0.0, samples, ends));
    }
}
