// How near an orbit comes to some shapes.

struct Traps {
    /// Least distances to a point, a line, a plane and a sphere.
    near: vec4<f32>,
    /// That to a cross.
    across: f32,
    /// Iterations until it escaped.
    iterations: f32,
    /// How often it was folded.
    folds: u32,
}

fn traps_start() -> Traps {
    return Traps(vec4<f32>(1e10), 1e10, 0.0, 0u);
}

/// Adds a point of the orbit; the sphere has this radius.
fn traps_add(all: ptr<function, Traps>, z: vec3<f32>, radius: f32) {
    let a = abs(z);
    let l = length(a);
    let distances = vec4<f32>(l, length(a.xy), a.z, abs(l - radius));
    (*all).near = min((*all).near, distances);
    let across = min(length(a.yz), min(length(a.zx), length(a.xy)));
    (*all).across = min((*all).across, across);
}

/// The numbers that pick colours. A distance of `size` becomes 1/2.
fn traps_numbers(all: Traps, size: f32) -> array<f32, 7> {
    let near = all.near / (all.near + size);
    return array<f32, 7>(
        near.x,
        near.y,
        near.z,
        near.w,
        all.across / (all.across + size),
        0.1 * all.iterations,
        0.1 * f32(all.folds),
    );
}
