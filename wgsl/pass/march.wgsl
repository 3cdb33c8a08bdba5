// One level of the pyramid: every cell advances its cone from the front of its parent, as far
// as the scene proves it free. Children of sky cells are not visited.

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
    var f = 0.0;
    if turn.done > 0u {
        f = cell_front(index);
    } else {
        f = queue_front(local);
    }
    var cone = view_cone(turn.stage.origin + local, turn.stage.divisor);
    cone.k *= turn.stage.fudge;
    // The children go on from the front, whether the cell stopped or reached its step limit.
    var s = STATE_MOVING;
    let last = queue_steps();
    for (var i = 0u; i < last; i++) {
        let next = advance(cone, f);
        f = next.front;
        if f > bounds_far() {
            s = STATE_SKY;
            break;
        }
        if !next.going {
            s = STATE_HIT;
            break;
        }
    }
    if s == STATE_MOVING && queue_push(packed) {
        s = STATE_UNCONVERGED;
    }
    cell_store(index, f, s);
    // The next stage starts with the children of the cells that are not sky.
    if s == STATE_HIT || s == STATE_UNCONVERGED {
        queue_parent(packed);
    }
    counters_store(index);
}
