// A cone's way over the pyramid of maxima: how far all of its rays are proven to pass above the
// surface.
//
// All of it is linear in the distance t. The rays of the cone are in a box about the axis, whose
// half sides grow with t. A window is two by two neighbouring nodes of one level that hold the
// box seen from above. Until the box leaves the window, the underside of the box is lowest at
// one of the two ends of that part. So it is enough to test both ends against the highest of
// the four nodes.

override CONE_WINDOWS: u32;
override CONE_FIT: f32;
/// More than the roundings of f32, in exits, ways down, fronts and clipped ends.
override CONE_EXIT: f32;
override CONE_DESCENT: f32;
override CONE_FRONT: f32;
override CONE_CLIP: f32;
/// An edge that no cone reaches, and the least speed by which a way is divided.
override CONE_NO_EDGE: f32;
override CONE_SLOW: f32;
/// The least step, as a share of t.
override CONE_LEAST: f32;

/// A cone in local units. At t, its rays are at most `radius + t growth` off its axis along each
/// coordinate. The radius has twice the slack in it.
struct LocalCone {
    origin: vec3<f32>,
    axis: vec3<f32>,
    radius: vec3<f32>,
    growth: vec3<f32>,
    slack: vec3<f32>,
}

/// Two by two nodes of a level: their edges, and the highest point under them.
struct Window {
    low: vec2<f32>,
    high: vec2<f32>,
    maximum: f32,
}

/// The part of x..y in which the cone meets the block below the height `top`, a little longer;
/// the end is before the start if there is none.
fn cone_within(cone: LocalCone, top: f32, part: vec2<f32>) -> vec2<f32> {
    let sides = vec3<f32>(vec2<f32>(heightmap.domain), top);
    // Each face is met where `room + t gain` is not negative.
    let room = array<vec3<f32>, 2>(
        cone.origin + cone.radius,
        sides - cone.origin + cone.radius,
    );
    let gain = array<vec3<f32>, 2>(cone.growth + cone.axis, cone.growth - cone.axis);
    var near = part.x;
    var far = part.y;
    for (var i = 0; i < 2; i++) {
        let meets = -room[i] / max(abs(gain[i]), vec3<f32>(CONE_SLOW));
        let begins = select(vec3<f32>(near), meets - CONE_CLIP * abs(meets), gain[i] > vec3<f32>(CONE_SLOW));
        near = max(near, max(begins.x, max(begins.y, begins.z)));
        let never = select(vec3<f32>(far), vec3<f32>(-1.0), room[i] < vec3<f32>(0.0));
        let ends = select(-meets + CONE_CLIP * abs(meets), never, gain[i] >= vec3<f32>(-CONE_SLOW));
        let cease = select(ends, vec3<f32>(far), gain[i] > vec3<f32>(CONE_SLOW));
        far = min(far, min(cease.x, min(cease.y, cease.z)));
    }
    return vec2<f32>(near, far);
}

/// The window of a level whose node at the rear, seen along the cone's way, holds a place. Each
/// tile begins nodes of its own.
fn cone_window(level: u32, rear: vec2<f32>, back: vec2<bool>) -> Window {
    let domain = heightmap.domain;
    let cells = heightmap.cells;
    let place = floor(rear);
    let inside = clamp(place, vec2<f32>(0.0), vec2<f32>(domain - 1));
    let cell = vec2<i32>(inside);
    let own = heightmap_tile_cell(cell);
    let tile = cell - own;
    // The window before the node or the one after it. Outside of the block it is the outer one.
    let after = select(place >= inside, place > inside, back);
    let at = (own >> vec2<u32>(level)) + select(vec2<i32>(0), vec2<i32>(1), after);
    let width = vec2<i32>(1i << level);
    let nodes = (cells + width - 1) >> vec2<u32>(level);
    let at_cell = at << vec2<u32>(level);
    // The last node of the tile before may be narrow.
    let before = ((nodes - 1) << vec2<u32>(level)) - cells;
    let low = tile + select(at_cell - width, before, at == vec2<i32>(0));
    let high = tile + select(min(at_cell + width, cells), cells + min(width, cells), at == nodes);
    // All tiles are alike.
    let whole = width >= cells;
    let start = heightmap.windows[level >> 2u][level & 3u];
    return Window(
        select(vec2<f32>(low), vec2<f32>(-CONE_NO_EDGE), whole | (low <= vec2<i32>(0))),
        select(vec2<f32>(high), vec2<f32>(CONE_NO_EDGE), whole | (high >= domain)),
        maxima[start + u32(at.y * (nodes.x + 1) + at.x)],
    );
}

/// The front of a cone that starts at a proven one. It is `end` if all of the cone's rays pass
/// the block.
fn maxima_cone(cone: LocalCone, front: f32, end: f32) -> Advance {
    let coarsest = heightmap.levels - 1u;
    let top = maxima[maxima_place(coarsest, vec2<u32>(0u))];
    let part = cone_within(cone, top, vec2<f32>(front, end));
    var t = part.x;
    // Levels above the least one of a window that holds the box, and the fewest that do.
    var lift = 0u;
    var least = 0u;
    var going = true;
    let slow = vec2<f32>(CONE_SLOW);
    let ahead = max(cone.growth.xy + cone.axis.xy, slow);
    let behind = max(cone.growth.xy - cone.axis.xy, slow);
    let back = cone.axis.xy < vec2<f32>(0.0);
    for (var i = 0u; i < CONE_WINDOWS; i++) {
        if t >= part.y {
            return advance_at(end, going);
        }
        count_evaluation();
        let p = cone.origin + t * cone.axis;
        let half = cone.radius + t * cone.growth;
        let wide = CONE_FIT * (max(half.x, half.y) + max(cone.slack.x, cone.slack.y));
        // The least level with windows whose nodes are wider than that.
        let fits = max(32u - countLeadingZeros(u32(min(wide, 1e6))), heightmap.finest);
        lift = min(lift, max(coarsest, fits) - fits);
        let level = min(fits + lift, coarsest);
        let low = p - half;
        let high = p.xy + half.xy;
        let rear = select(low.xy - cone.slack.xy, high + cone.slack.xy, back);
        let window = cone_window(level, rear, back);
        // Where a tile ends with a narrow node, the box may be too wide for two.
        if any(low.xy < window.low) || any(high > window.high) {
            lift += 1u;
            least = lift;
            continue;
        }
        // Where the box leaves the window.
        let exits = min((window.high - high) / ahead, (low.xy - window.low) / behind);
        let exit = max(min(exits.x, exits.y) * CONE_EXIT, CONE_LEAST * t);
        let step = min(exit, part.y - t);
        let over = low.z - window.maximum;
        let fall = cone.axis.z - cone.growth.z;
        if over > 0.0 && over + step * fall > 0.0 {
            t += step;
            lift += 1u;
            least = 0u;
            continue;
        }
        if over > 0.0 {
            t += over / -fall * CONE_DESCENT;
        }
        if lift <= least {
            going = false;
            break;
        }
        lift -= 1u;
        if over > 0.0 {
            least = 0u;
        }
    }
    return advance_at(max(front, t * CONE_FRONT), going);
}
