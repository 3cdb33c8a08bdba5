// One level of the pyramid: every cell advances its cone from the front of its parent, as far
// as the scene proves it free. Children of sky cells are not visited.

/// The cones that still move between two dispatches. All others are out of date.
@group(2) @binding(3) var<storage, read_write> walks: array<Advance>;

@compute @workgroup_size(64)
fn march(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    scene_load();
    view_load();
    queue_load();
    let packed = queue_take(group.xy, lane);
    if packed == QUEUE_NONE {
        return;
    }
    let local = queue_cell(packed);
    let index = queue_index(local);
    var at: Advance;
    if turn.done > 0u {
        at = walks[index];
    } else {
        at = advance_at(queue_front(local), true);
    }
    var cone = view_cone(turn.stage.origin + local, turn.stage.divisor);
    cone.k *= turn.stage.fudge;
    // The children go on from the front, whether the cell stopped or reached its step limit.
    var s = STATE_MOVING;
    let last = queue_steps();
    for (var i = 0u; i < last; i++) {
        at = advance(cone, at);
        if at.front > bounds_far() {
            s = STATE_SKY;
            break;
        }
        if at.going == 0u {
            s = STATE_HIT;
            break;
        }
    }
    if s == STATE_MOVING {
        if queue_push(packed) {
            s = STATE_UNCONVERGED;
        } else {
            walks[index] = at;
        }
    }
    cell_store(index, at.front, s);
    // The next stage starts with the children of the cells that are not sky.
    if s == STATE_HIT || s == STATE_UNCONVERGED {
        queue_parent(packed);
    }
    tally_store(index);
}
