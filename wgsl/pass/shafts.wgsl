// Sun shafts: light of the sun that fog scatters toward the eye once, by one point and one shadow ray
// for each sample. It takes the place of the sky's halo in the fog.

/// How far fog scatters forward: the mean cosine of Henyey and Greenstein (1941).
const SHAFTS_FORWARD = 0.6;
/// The purposes of the random numbers: those of paths are below 128, or above 129.
const SHAFTS_PURPOSE = 128u;
/// Halvings of the way: what is left is less than its rounding.
const SHAFTS_HALVINGS = 24u;

/// The share of light that fog scatters into a direction, per steradian, for the cosine of the
/// angle by which it turns.
fn shafts_phase(cosine: f32) -> f32 {
    let g = SHAFTS_FORWARD;
    let away = 1.0 + g * g - 2.0 * g * cosine;
    return (1.0 - g * g) / (12.566370614 * away * sqrt(away));
}

/// How far a ray goes through fog of a depth, which is at most that of `end`.
fn shafts_way(ray: Beam, end: f32, depth: f32) -> f32 {
    var low = 0.0;
    var high = end;
    for (var i = 0u; i < SHAFTS_HALVINGS; i++) {
        let middle = 0.5 * (low + high);
        if fog_depth(ray, middle) < depth {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

/// A colour behind `end` units of fog that has its share of the sky, with shafts in place of the halo;
/// and 0 if the ray to the sun reached its step limit, else 1.
fn shafts(color: vec3<f32>, ray: Beam, end: f32, pixel: vec2<u32>) -> vec4<f32> {
    let full = look_parameters.shafts.light;
    // A program may be kept when the number becomes zero.
    if all(full == vec3<f32>(0.0)) {
        return vec4<f32>(color, 1.0);
    }
    let share = 1.0 - exp(-fog_depth(ray, end));
    let seed = random_seed(pixel);
    let sun = Lamp(look.light, 2.0 * bounds_far(), look.softness);
    // A picture without noise: the middle of the fog and of the sun.
    var at = 0.5;
    var toward = sun.axis;
    if look.discs != 0u {
        at = random_pair(seed, turn.stage.before, SHAFTS_PURPOSE).x;
        toward = aim(sun, random_pair(seed, turn.stage.before, SHAFTS_PURPOSE + 1u));
    }
    let t = shafts_way(ray, end, -log(1.0 - at * share));
    let beam = Beam(ray.origin + t * ray.axis, toward, 0.0, 0.0, footprint(ray, t), 0.0);
    var walk = begin(beam, 0.0, sun.far);
    var state = STATE_UNCONVERGED;
    for (var i = 0u; i < look_parameters.shafts.steps; i++) {
        let now = walk_step(beam, &walk);
        if now != STATE_MOVING {
            state = now;
            break;
        }
    }
    var c = color - share * sky_halo(ray.axis);
    if state == STATE_SKY {
        c += share * shafts_phase(dot(ray.axis, look.light)) * full;
    }
    // The difference may round below nothing.
    return vec4<f32>(max(c, vec3<f32>(0.0)), select(1.0, 0.0, state == STATE_UNCONVERGED));
}
