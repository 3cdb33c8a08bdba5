// Light and palette: the part of a look that needs no geometry.

struct LookUniform {
    /// Unit vector to the light, and the light's strength.
    light: vec3<f32>,
    key: f32,
    light_color: vec3<f32>,
    fill: f32,
    sky_high: vec3<f32>,
    /// Extinction per unit of length.
    fog: f32,
    sky_low: vec3<f32>,
    /// 1 if rays to lights go to points of their discs, 0 if they go to the middle.
    discs: u32,
    world_up: vec3<f32>,
    /// Tangent of the sun's angular radius.
    softness: f32,
    /// Length over which occlusion looks for neighbours.
    occlusion_reach: f32,
    occlusion_strength: f32,
    shadow_steps: u32,
    stops: u32,
    palette_cycles: f32,
    /// 1 to paint unconverged pixels in magenta.
    flag: u32,
    /// The share of the lower sky's light that the ground sends back to surfaces.
    ground: f32,
    /// How often light goes from surface to surface before the last one, if it is followed.
    bounces: u32,
    /// Number of lamps.
    lamps: u32,
    /// How near the trap the glow ends.
    emission_width: f32,
    unused: vec2<u32>,
    emission: vec3<f32>,
    /// The trap that glows, from 0 to 2.
    emission_trap: u32,
    /// Scale heights of the fog per unit of length, 0 for fog of one density, and how many of
    /// them the eye is above the fog's level.
    fog_rise: f32,
    fog_start: f32,
    /// The most steps of a path of light.
    path_steps: u32,
    /// 1 if colours of palettes are in Oklab.
    oklab: u32,
    palette: array<vec4<f32>, 16>,
}

/// A light as a point sees it: the direction to it, its distance, and the tangent of its angular
/// radius.
struct Lamp {
    axis: vec3<f32>,
    far: f32,
    softness: f32,
}

/// What a shadow ray found.
struct Shadow {
    /// Share of the light that arrives, as far as the ray came.
    open: f32,
    /// Whether the ray reached its end before its step limit.
    decided: bool,
}

/// What surfaces are made of (`material.wgsl`).
struct MaterialUniform {
    /// The square of the roughness.
    alpha: f32,
    /// 0 for a coat over a base, 1 for a bare metal.
    metal: f32,
    /// What the coat reflects of light along the normal.
    specular: f32,
    pad: u32,
    /// Two directions each: the share of light that mirrors without absorption reflect, without and
    /// with the factor (1 - v.h)^5. The square root of v.z goes from 0 to 1.
    shares: array<vec4<f32>, 32>,
}

/// A lamp in the scene (`lamp.wgsl`).
struct LampUniform {
    /// Its position relative to the eye, and its radius.
    at: vec3<f32>,
    size: f32,
    /// Its colour times its strength at distance 1.
    light: vec3<f32>,
    /// Squares of the distance from `toward` to a unit direction, where full light ends and where
    /// all light ends.
    full: f32,
    /// Unit direction of the middle of its cone.
    toward: vec3<f32>,
    none: f32,
}

/// Light of the air near the surface (`glow.wgsl`).
struct GlowUniform {
    /// Radiance of a whole way to a flat wall.
    light: vec3<f32>,
    /// Widths per unit of length.
    rate: f32,
    /// Parts of a ray at most.
    parts: u32,
    pad: array<u32, 3>,
}

/// Light of the sun in the fog (`shafts.wgsl`).
struct ShaftsUniform {
    /// What lit fog scatters into all directions together.
    light: vec3<f32>,
    /// Step limit of a ray from the fog to the sun.
    steps: u32,
}

/// The sky of a file (`sky_file.wgsl`).
struct SkyUniform {
    /// To the right of the file's middle, and the factor of its light.
    right: vec3<f32>,
    strength: f32,
    /// Toward its middle.
    forward: vec3<f32>,
    width: u32,
    up: vec3<f32>,
    height: u32,
    /// Irradiance over pi, in spherical harmonics.
    bands: array<vec4<f32>, 9>,
}

struct LookParameters {
    look: LookUniform,
    material: MaterialUniform,
    lamps: array<LampUniform, 3>,
    glow: GlowUniform,
    shafts: ShaftsUniform,
    sky: SkyUniform,
}

@group(1) @binding(1) var<storage, read> look_parameters: LookParameters;
var<private> look: LookUniform;

fn look_load() {
    look = look_parameters.look;
}

/// Oklab to linear sRGB (Ottosson 2020). What a screen cannot show is cut to no light.
const PALETTE_FROM_LAB = mat3x3<f32>(
    1.0, 1.0, 1.0,
    0.3963377774, -0.1055613458, -0.0894841775,
    0.2158037573, -0.0638541728, -1.2914855480,
);
const PALETTE_FROM_CONES = mat3x3<f32>(
    4.0767416621, -1.2684380046, -0.0041960863,
    -3.3077115913, 2.6097574011, -0.7034186147,
    0.2309699292, -0.3413193965, 1.7076147010,
);

/// The linear colour of one in the space of palettes.
fn palette_linear(c: vec3<f32>) -> vec3<f32> {
    if look.oklab == 0u {
        return c;
    }
    let cones = PALETTE_FROM_LAB * c;
    return max(PALETTE_FROM_CONES * (cones * cones * cones), vec3<f32>(0.0));
}

/// The palette at x. Its colours are evenly spaced from 0 to 1 and blended smoothly.
fn palette_at(x: f32) -> vec3<f32> {
    let last = f32(look.stops - 1u);
    // A triangle wave repeats without a seam.
    let phase = abs(x * look.palette_cycles - 2.0 * round(0.5 * x * look.palette_cycles));
    let at = clamp(phase, 0.0, 1.0) * last;
    let i = min(u32(at), look.stops - 1u);
    let j = min(i + 1u, look.stops - 1u);
    let f = at - f32(i);
    // Not from the copy: an array with a variable index cannot be in registers.
    let one = look_parameters.look.palette[i].rgb;
    let two = look_parameters.look.palette[j].rgb;
    return palette_linear(mix(one, two, f * f * (3.0 - 2.0 * f)));
}

fn pigment_color(pigment: vec3<f32>) -> vec3<f32> {
    // The first number picks the hue, the other two the brightness.
    let base = palette_at(pigment.x);
    return base * (0.55 + 0.45 * pigment.y) * (0.85 + 0.3 * pigment.z);
}
