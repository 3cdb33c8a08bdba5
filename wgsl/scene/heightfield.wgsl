// A heightfield: a block whose top is a height map. A module of `heightfield/tracer` follows the
// rays, in local units: texels along the sides of the block, and heights from 0 to 1. Cones and
// empty balls are tested against the highest point of the map below them.

struct HeightfieldUniform {
    /// Rows of the matrix from world directions to local units.
    row_x: vec3<f32>,
    /// World length of a texel.
    texel: f32,
    row_y: vec3<f32>,
    /// World length of the height 1.
    depth: f32,
    row_z: vec3<f32>,
    /// Nothing is farther from the eye.
    far: f32,
    /// The eye, in local units.
    eye: vec3<f32>,
    /// Shadow rays start at this distance from exact hits.
    lift: f32,
    /// More than the rounding error of local coordinates.
    slack: vec3<f32>,
    pad1: f32,
    map: HeightmapUniform,
}

/// What roundings may take from the square of a sine, and from the growth of a cone.
const SQUARE_SLACK = 1e-6;
const GROWTH_SLACK = 4e-7;

/// Windows that are tried in the search of an empty ball.
override HEIGHTFIELD_SEARCHES: u32;
/// Weight of the height above the surface in a guess of the free room.
override HEIGHTFIELD_GUESS: f32;
/// Whether hits are exact.
override HEIGHTFIELD_EXACT: bool;
override HIT_CARRIES_MARK: bool;
/// Whether normals change steadily from patch to patch.
override HEIGHTFIELD_SMOOTH: bool;
/// Whether pigments are colours, and the grey of walls then.
override HEIGHTFIELD_COLORED: bool;
override HEIGHTFIELD_WALL: f32;

@group(0) @binding(0) var<storage, read> heightfield_parameters: HeightfieldUniform;
var<private> heightfield: HeightfieldUniform;

struct Walk {
    t: f32,
    trace: Trace,
}

fn scene_load() {
    heightfield = heightfield_parameters;
    heightmap = heightfield_parameters.map;
}

fn bounds_far() -> f32 {
    return heightfield.far;
}

/// A world direction in local units.
fn to_local(v: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        dot(heightfield.row_x, v), dot(heightfield.row_y, v), dot(heightfield.row_z, v),
    );
}

fn local_units() -> vec3<f32> {
    return vec3<f32>(heightfield.texel, heightfield.texel, heightfield.depth);
}

/// The world distance from a local position to the block; negative inside.
fn block_distance(p: vec3<f32>) -> f32 {
    let half = 0.5 * vec3<f32>(vec2<f32>(heightmap.domain), 1.0);
    let o = (abs(p - half) - half) * local_units();
    return length(max(o, vec3<f32>(0.0))) + min(max(o.x, max(o.y, o.z)), 0.0);
}

/// The way of a cone over the maxima. At t the rays of the cone are within r0 + k t of the axis.
fn advance(cone: Beam, at: Advance) -> Advance {
    let units = local_units();
    let axis = to_local(cone.axis);
    // Unit vectors that differ by k differ by k²/2 along either of them.
    let along = abs(axis * units);
    let across = sqrt(max(vec3<f32>(1.0) - along * along, vec3<f32>(0.0)) + SQUARE_SLACK);
    let growth = cone.k * (across + 0.5 * cone.k * along) + GROWTH_SLACK;
    let own = LocalCone(
        heightfield.eye + to_local(cone.origin),
        axis,
        cone.r0 / units + 2.0 * heightfield.slack,
        min(growth, vec3<f32>(cone.k)) / units,
        heightfield.slack,
    );
    // Nothing is as far as that.
    return maxima_cone(own, at.front, heightfield.far * 1.0001);
}

fn begin(ray: Beam, front: f32, t_max: f32) -> Walk {
    let origin = heightfield.eye + to_local(ray.origin);
    // The tracer ends the ray where the block ends.
    let trace = trace_begin(origin, to_local(ray.axis), front, t_max);
    return Walk(front, trace);
}

fn walk_step(ray: Beam, walk: ptr<function, Walk>) -> u32 {
    var trace = (*walk).trace;
    let origin = heightfield.eye + to_local(ray.origin);
    let s = trace_step(origin, to_local(ray.axis), &trace);
    (*walk).trace = trace;
    (*walk).t = trace.s;
    return s;
}

fn walk_hit(ray: Beam, walk: Walk) -> Hit {
    return trace_hit(heightfield.eye + to_local(ray.origin), to_local(ray.axis), walk.trace);
}

/// How far from the surface shadow rays start.
fn shadow_lift(grain: f32) -> f32 {
    // Another hit may be below the surface.
    return select(max(heightfield.lift, 4.0 * grain), heightfield.lift, HEIGHTFIELD_EXACT);
}

/// The world distance from a local position to the surface straight below it. Beside the block
/// it is the distance to the edge of the top, or to the wall below that edge.
fn surface_gap(p: vec3<f32>) -> f32 {
    let sides = vec2<f32>(heightmap.domain);
    let inside = clamp(p.xy, vec2<f32>(0.0), sides);
    let cell = min(floor(inside), max(sides - 1.0, vec2<f32>(0.0)));
    let height = heightmap_height(vec2<i32>(cell), inside - cell);
    let above = max(0.0, (p.z - height) * heightfield.depth);
    return length(vec3<f32>((p.xy - inside) * heightfield.texel, above));
}

/// The radius of a ball about a local position that is proven empty, from windows of maxima. The
/// search ends where the radius is at least `enough`, or where no window has more room.
fn empty_radius(p: vec3<f32>, enough: f32) -> f32 {
    let slack = max(heightfield.slack.x, heightfield.slack.y);
    var free = block_distance(p);
    // The least level with windows whose nodes are wider than such a ball.
    let wide = 2.0 * (max(enough, 0.0) / heightfield.texel + slack);
    let fits = 32u - countLeadingZeros(u32(min(wide, 1e6)));
    var level = min(max(fits, heightmap.finest), heightmap.levels - 1u);
    for (var i = 0u; i < HEIGHTFIELD_SEARCHES; i++) {
        // Within the map, the room in a window is at most as wide as one of its nodes.
        if free >= min(enough, heightfield.texel * f32(1u << level)) {
            break;
        }
        count_evaluation();
        // The point is at least half a node from every side of the window.
        let corner = p.xy - 0.5 * f32(1u << level);
        let window = cone_window(level, corner, vec2<bool>(false));
        let sides = min(p.xy - window.low, window.high - p.xy) - slack;
        let room = min(sides.x, sides.y) * heightfield.texel;
        let gap = (p.z - heightfield.slack.z - window.maximum) * heightfield.depth;
        free = max(free, min(room, gap));
        // A smaller window has less room.
        if gap >= room || level == heightmap.finest {
            break;
        }
        level--;
    }
    return max(0.0, free);
}

/// The radius of a ball about a point that is proven empty.
fn clearance(q: vec3<f32>) -> f32 {
    let p = heightfield.eye + to_local(q);
    // The ball cannot reach below the surface.
    return empty_radius(p, surface_gap(p));
}

/// The free room about a point, for occlusion, exact up to `enough`. It is a mean of two values:
/// the proven radius is far too small over steep ground, and the height above the surface ignores
/// what stands beside the point.
fn room(q: vec3<f32>, enough: f32) -> f32 {
    let p = heightfield.eye + to_local(q);
    let gap = surface_gap(p);
    let rest = (enough - HEIGHTFIELD_GUESS * gap) / (1.0 - HEIGHTFIELD_GUESS);
    return mix(empty_radius(p, rest), gap, HEIGHTFIELD_GUESS);
}

/// The world direction of a local normal.
fn to_world(v: vec3<f32>) -> vec3<f32> {
    return heightfield.texel * (v.x * heightfield.row_x + v.y * heightfield.row_y)
        + heightfield.depth * v.z * heightfield.row_z;
}

/// The local normal of the side through which a ray entered a box: that of the grid line that
/// it crossed last before the place `uv`.
fn box_side(d: vec3<f32>, uv: vec2<f32>) -> vec3<f32> {
    let flat = abs(d.xy) < vec2<f32>(GRID_FLAT);
    let slope = select(abs(d.xy), vec2<f32>(1.0), flat);
    let way = select(1.0 - uv, uv, d.xy > vec2<f32>(0.0));
    let since = select(way / slope, vec2<f32>(GRID_FAR), flat);
    let out = select(vec2<f32>(1.0), vec2<f32>(-1.0), d.xy > vec2<f32>(0.0));
    return select(vec3<f32>(0.0, out.y, 0.0), vec3<f32>(out.x, 0.0, 0.0), since.x <= since.y);
}

fn surface(ray: Beam, hit: Hit) -> Surface {
    let face = hit.id >> FACE_BITS;
    if face != 0u {
        var n = vec3<f32>(0.0, 0.0, -1.0);
        if face <= 2u {
            n = vec3<f32>(select(1.0, -1.0, face == 1u), 0.0, 0.0);
        } else if face <= 4u {
            n = vec3<f32>(0.0, select(1.0, -1.0, face == 3u), 0.0);
        }
        let plain = vec3<f32>(HEIGHTFIELD_WALL);
        return Surface(to_world(n), select(vec3<f32>(0.0, 0.3, 0.3), plain, HEIGHTFIELD_COLORED));
    }
    let index = i32(hit.id & 0x0fffffffu);
    let cell = vec2<i32>(index % heightmap.cells.x, index / heightmap.cells.x);
    let c = heightmap_corners(cell);
    if HEIGHTMAP_BOXES {
        let d = to_local(ray.axis);
        let height = heightfield.eye.z + to_local(ray.origin).z + hit.t * d.z;
        // Below the top of its box by more than rounding: the hit is on a side.
        if height < c.x - heightfield.slack.z {
            let pigment = heightmap_paint(cell, hit.uv, height, 0.0);
            return Surface(to_world(box_side(d, hit.uv)), pigment);
        }
    }
    var slope = vec2<f32>(
        mix(c.y - c.x, c.w - c.z, hit.uv.y), mix(c.z - c.x, c.w - c.y, hit.uv.x),
    );
    if HEIGHTFIELD_SMOOTH {
        slope = heightmap_smooth_slope(cell, hit.uv);
    }
    let steep = slope * (heightfield.depth / heightfield.texel);
    let n = normalize(vec3<f32>(-steep, 1.0));
    let z = mix(mix(c.x, c.y, hit.uv.x), mix(c.z, c.w, hit.uv.x), hit.uv.y);
    // Steep ground is darker.
    return Surface(to_world(n), heightmap_paint(cell, hit.uv, z, n.z));
}
