// What all generators of cone maps share: which place an invocation works on, what it
// has found so far, and how it continues where an earlier dispatch stopped.
//
// A dispatch covers a band of rows and lets each place take a bounded number of rounds;
// it is repeated for the places that are not done. So no dispatch is long, however large the
// map is: software Vulkan ends any loop after 65 535 rounds, and drivers give up a device
// that takes seconds.
//
// The result for a place is not a ratio but the place that bounds its cone, as squared
// distance and height. The twin computes the ratio from them in f64. Near ties in f32 are
// marked, and searched again in f64, so that a map from the device equals one from the CPU.

struct GenerateUniform {
    /// Places along each axis, and whether they wrap.
    size: vec2<u32>,
    wrap: vec2<u32>,
    /// First row of the band, and rows of it.
    first: u32,
    rows: u32,
    /// Rounds that a place may take in this dispatch.
    rounds: u32,
    /// Levels of tiles.
    levels: u32,
    /// Whether this dispatch begins a search, and whether it keeps what another one has found.
    begins: u32,
    keeps: u32,
    /// The number of the quadrant or side that is searched.
    sector: u32,
    /// Steps along a ray.
    steps: u32,
    /// Room that a walk's cones leave, in texels.
    offset: f32,
    /// The highest of all that bounds cones.
    top: f32,
    pad0: u32,
    pad1: u32,
    /// Where each level's tiles begin, by level.
    at: array<vec4<u32>, 4>,
}

/// The search from one place.
struct SearchState {
    /// What bounds the cone: squared distance, and height, which is below 0 for nothing.
    squared: u32,
    top: f32,
    /// 1 for nearly a tie, or the step at which a ray came out.
    note: u32,
    /// How far the search has come, from 0 to SEARCH_DONE.
    stage: u32,
    /// Where it continues.
    node_x: u32,
    node_y: u32,
    pending_low: u32,
    pending_high: u32,
}

const SEARCH_DONE = 0xffffffffu;

@group(0) @binding(0) var<storage, read> generate_parameters: GenerateUniform;
/// Heights of samples, or apexes of cells, row by row.
@group(0) @binding(1) var<storage, read> heights: array<f32>;
/// One per place of the band.
@group(0) @binding(3) var<storage, read_write> searches: array<SearchState>;

var<private> params: GenerateUniform;
/// Apex of this place's cone, and the least cost so far.
var<private> apex: f32;
var<private> best: f32;

fn generate_load() {
    params = generate_parameters;
}

/// Square tiles of 8 x 8 places in Morton order: the few places that a device runs in
/// step are neighbours, and take about as many rounds.
fn place_of(group: vec2<u32>, lane: u32) -> vec2<u32> {
    let x = (lane & 1u) | ((lane >> 1u) & 2u) | ((lane >> 2u) & 4u);
    let y = ((lane >> 1u) & 1u) | ((lane >> 2u) & 2u) | ((lane >> 3u) & 4u);
    return group * 8u + vec2<u32>(x, y);
}

@compute @workgroup_size(64)
fn generate(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    generate_load();
    let in_band = place_of(group.xy, lane);
    if in_band.x >= params.size.x || in_band.y >= params.rows {
        return;
    }
    let index = in_band.y * params.size.x + in_band.x;
    let place = vec2<u32>(in_band.x, in_band.y + params.first);
    var s = searches[index];
    if params.begins != 0u {
        if params.keeps == 0u {
            s.squared = 0u;
            s.top = -1.0;
            s.note = 0u;
        }
        s.stage = 0u;
        s.node_x = 0u;
        s.node_y = 0u;
        s.pending_low = 0u;
        s.pending_high = 0u;
    }
    if s.stage == SEARCH_DONE {
        return;
    }
    apex = heights[place.y * params.size.x + place.x];
    best = COST_WIDEST;
    if s.top >= 0.0 {
        best = cost_kept(s);
    }
    work(place, &s);
    searches[index] = s;
}
