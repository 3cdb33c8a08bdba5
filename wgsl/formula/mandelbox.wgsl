// The Mandelbox (docs/method.md, 3): box fold, ball fold, rotation, scale, translation.
//
//     b = 2 clamp(z, -L, L) - z;   m = f2 / clamp(|b|^2, r2, f2)
//     z' = s m R b + c;            w' = |s| m w + 1
//
// The estimate grows with every iteration and never exceeds the limit of |z|/w:
//
//     DE = (|z| - K) / (w + 1/(|s| - 1)),   K = (2 sqrt(3) L |s| + |c|) / (|s| - 1)
//
// In Julia mode c is a constant, w gains no 1, and DE = (|z| - K)/w. `trap` follows the orbit
// again, for the colour of a hit.

struct MandelboxUniform {
    julia: vec3<f32>,
    scale: f32,
    fold_limit: f32,
    /// Squares of the two radii.
    min2: f32,
    fixed2: f32,
    /// The orbit has escaped where |z|^2 exceeds this: (20 K)^2 at the largest |c|.
    bail2: f32,
    /// K for c = 0, which is 2 sqrt(3) L |s| / (|s| - 1), and 1 / (|s| - 1).
    k_at_zero: f32,
    tail: f32,
    /// |s - 1| and |s|^(1 - iterations), of the classic estimate.
    classic_offset: f32,
    classic_skin: f32,
}

override MANDELBOX_JULIA: bool;
override MANDELBOX_CLASSIC: bool;

/// w stays below this, as its product with the next factor could overflow. The estimate is
/// zero in f32 before this limit.
const MANDELBOX_MOST_W = 1e30;

@group(0) @binding(1) var<storage, read> mandelbox_parameters: MandelboxUniform;
var<private> mandelbox: MandelboxUniform;

fn formula_load() {
    mandelbox = mandelbox_parameters;
    rotation_load();
}

fn estimate(p: real3, most: u32) -> real {
    let limit = real(mandelbox.fold_limit);
    let low = real(mandelbox.min2);
    let high = real(mandelbox.fixed2);
    let bail2 = real(mandelbox.bail2);
    let scaled = real(mandelbox.scale) * high;
    let grown = abs(scaled);
    var c = p;
    var gain = real(1.0);
    if MANDELBOX_JULIA {
        c = real3(mandelbox.julia);
        gain = real(0.0);
    }
    var z = p;
    var w = real(1.0);
    var z2 = dot(z, z);
    var n = 0u;
    while n < most && z2 <= bail2 {
        let b = real(2.0) * clamp(z, real3(-limit), real3(limit)) - z;
        let m = real(1.0) / clamp(dot(b, b), low, high);
        z = (scaled * m) * rotate(b) + c;
        w = min(grown * m * w + gain, real(MANDELBOX_MOST_W));
        z2 = dot(z, z);
        n += 1u;
    }
    count_evaluation();
    count_iterations(n);
    if MANDELBOX_CLASSIC {
        return (sqrt(z2) - real(mandelbox.classic_offset)) / w - real(mandelbox.classic_skin);
    }
    let tail = real(mandelbox.tail);
    let bound = real(mandelbox.k_at_zero) + length(c) * tail;
    if MANDELBOX_JULIA {
        return (sqrt(z2) - bound) / w;
    }
    return (sqrt(z2) - bound) / (w + tail);
}

/// Three orbit traps from 0 to 1: how near the orbit comes to the origin, to the coordinate
/// planes and to the fixed sphere.
fn trap(p: real3, most: u32) -> vec3<f32> {
    let limit = real(mandelbox.fold_limit);
    let low = real(mandelbox.min2);
    let high = real(mandelbox.fixed2);
    var c = p;
    if MANDELBOX_JULIA {
        c = real3(mandelbox.julia);
    }
    var z = p;
    var origin = real(1e10);
    var plane = real(1e10);
    var sphere = real(1e10);
    var n = 0u;
    // Later iterations only add noise to the colour.
    let last = min(most, 10u);
    while n < last && dot(z, z) <= real(mandelbox.bail2) {
        let b = real(2.0) * clamp(z, real3(-limit), real3(limit)) - z;
        let b2 = dot(b, b);
        let a = abs(b);
        origin = min(origin, b2);
        plane = min(plane, min(a.x, min(a.y, a.z)));
        sphere = min(sphere, abs(b2 - high));
        z = (real(mandelbox.scale) * high / clamp(b2, low, high)) * rotate(b) + c;
        n += 1u;
    }
    let size = real(mandelbox.fold_limit);
    return vec3<f32>(
        f32(sqrt(origin) / (sqrt(origin) + size)),
        f32(plane / (plane + real(0.25) * size)),
        f32(sphere / (sphere + high)),
    );
}
