// Pyramids of cone maps: of each node the highest apex and the narrowest cone under it.
// One dispatch makes one level of one channel.
//
// A cone that is raised and narrowed lies within the one that it was, so a node's cone
// holds over every place under it; averages would hold nowhere. Sizes halve rounding up.

struct MipUniform {
    /// Nodes along each axis of the level below, and of this level.
    below: vec2<u32>,
    size: vec2<u32>,
    /// Where both begin.
    below_at: u32,
    at: u32,
    pad0: u32,
    pad1: u32,
}

@group(0) @binding(0) var<storage, read> mip_parameters: MipUniform;
/// All levels after one another, row by row.
@group(0) @binding(1) var<storage, read_write> apexes: array<f32>;
@group(0) @binding(2) var<storage, read_write> ratios: array<f32>;
/// The parameters, copied once.
var<private> level: MipUniform;

fn mips_load() {
    level = mip_parameters;
}

@compute @workgroup_size(8, 8)
fn mips(@builtin(global_invocation_id) id: vec3<u32>) {
    mips_load();
    if any(id.xy >= level.size) {
        return;
    }
    // Beyond the last row or column the last one counts twice.
    let first = 2u * id.xy;
    let last = min(first + 1u, level.below - 1u);
    // Rows of the level below.
    let upper = level.below_at + first.y * level.below.x;
    let lower = level.below_at + last.y * level.below.x;
    let to = level.at + id.y * level.size.x + id.x;
    let high = max(apexes[upper + first.x], apexes[upper + last.x]);
    apexes[to] = max(high, max(apexes[lower + first.x], apexes[lower + last.x]));
    let narrow = min(ratios[upper + first.x], ratios[upper + last.x]);
    ratios[to] = min(narrow, min(ratios[lower + first.x], ratios[lower + last.x]));
}
