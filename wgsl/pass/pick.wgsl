// What there is at a pixel or at a point: one ray from the eye, or none, and the clearance where it
// ends. A ray needs no front: only one is traced.

/// What is asked.
struct PickQuestion {
    /// The point relative to the eye.
    point: vec3<f32>,
    /// 1 for the pixel, 0 for the point.
    traces: u32,
    pixel: vec2<u32>,
    /// The step limit of a dispatch. The next one goes on.
    steps: u32,
    /// The step limit of the ray.
    limit: u32,
}

/// What there is.
struct PickAnswer {
    /// The point that was met or asked for, relative to the eye.
    point: vec3<f32>,
    clearance: f32,
    distance: f32,
    state: u32,
    /// 1 if the ray has begun.
    begun: u32,
    /// Steps done.
    done: u32,
}

@group(2) @binding(0) var<storage, read> pick_question: PickQuestion;
@group(2) @binding(1) var<storage, read_write> pick_answer: PickAnswer;
/// The ray between two dispatches.
@group(2) @binding(2) var<storage, read_write> walks: array<Walk>;

@compute @workgroup_size(1)
fn pick() {
    scene_load();
    view_load();
    var at = pick_question.point;
    if pick_question.traces == 1u {
        if pick_answer.begun == 1u && pick_answer.state != STATE_MOVING {
            return;
        }
        let ray = view_ray(pick_question.pixel);
        var walk: Walk;
        if pick_answer.begun == 1u {
            walk = walks[0];
        } else {
            walk = begin(ray, 0.0, bounds_far());
        }
        var state = STATE_MOVING;
        let last = min(pick_question.steps, pick_question.limit - pick_answer.done);
        pick_answer.done += last;
        for (var i = 0u; i < last; i++) {
            state = walk_step(ray, &walk);
            if state != STATE_MOVING {
                break;
            }
        }
        walks[0] = walk;
        pick_answer.state = state;
        pick_answer.begun = 1u;
        at = ray.origin + walk_hit(ray, walk).t * ray.axis;
    }
    pick_answer.point = at;
    pick_answer.distance = length(at);
    pick_answer.clearance = clearance(at);
}
