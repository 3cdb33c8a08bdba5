// The stage after a cone level: it shows the fronts, each cell as a square of pixels. The normal
// follows from the differences between the fronts on either side, so this asks nothing of the
// scene. The two have the same place under their parents, whose fronts would show otherwise.

/// Light on a sketch that comes from everywhere, and what the sun adds.
const SKETCH_FILL = 0.25;
const SKETCH_KEY = 0.5;

/// The ray through the middle of a cell.
fn sketch_ray(cell: vec2<u32>) -> Beam {
    let corner = vec2<f32>(turn.stage.divisor * (turn.stage.origin + cell));
    return view_through(corner, vec2<f32>(0.5 * f32(turn.stage.divisor)));
}

/// Where the front of a cell is, relative to the eye; at the block's edge that of the last cell.
fn sketch_point(cell: vec2<i32>) -> vec3<f32> {
    let at = vec2<u32>(clamp(cell, vec2<i32>(0), vec2<i32>(turn.stage.cells) - 1));
    let front = cell_front(at.y * turn.stage.cells.x + at.x);
    let ray = sketch_ray(at);
    return ray.origin + front * ray.axis;
}

@compute @workgroup_size(64)
fn sketch(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    view_load();
    look_load();
    queue_load();
    let packed = queue_tile(group.xy, lane);
    if packed == QUEUE_NONE {
        return;
    }
    let cell = queue_cell(packed);
    let index = queue_index(cell);
    let at = vec2<i32>(cell);
    var c = sky(sketch_ray(cell).axis);
    let state = cell_state(turn.stage.state + index);
    if state == STATE_HIT || state == STATE_UNCONVERGED {
        let across = sketch_point(at + vec2<i32>(1, 0)) - sketch_point(at - vec2<i32>(1, 0));
        let down = sketch_point(at + vec2<i32>(0, 1)) - sketch_point(at - vec2<i32>(0, 1));
        let n = cross(down, across);
        // The front of a neighbour in the sky was never written: any normal will do there.
        let facing = dot(n, look.light) / max(length(n), 1e-20);
        let lit = SKETCH_FILL * look.fill + SKETCH_KEY * look.key * clamp(facing, 0.0, 1.0);
        c = palette_at(0.5) * lit;
    }
    let levels = tone_levels(c);
    let first = turn.stage.divisor * (turn.stage.origin + cell);
    let end = min(first + turn.stage.divisor, view.size);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            tone_store(vec2<u32>(x, y), levels);
        }
    }
}
