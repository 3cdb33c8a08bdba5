// The light of a sky in a file, in equirectangular form: `src/scene/sky.rs`.

const SKY_IS_SAMPLED = true;
/// Numbers in a row of the textures (`src/gpu/array.rs`).
const SKY_ROW = 8192u;
/// Cells of equal solid angle about the up axis and along it.
const SKY_CELLS = vec2<u32>(512u, 256u);
/// The exponent of a texel that is stored as 0, less the bits of its numbers.
const SKY_EXPONENT = 80;
const SKY_PI = 3.14159265;

@group(1) @binding(5) var sky_texels: texture_2d<u32>;
@group(1) @binding(6) var sky_cells: texture_2d<u32>;

/// A direction to the right, forward and up.
fn sky_own(axis: vec3<f32>) -> vec3<f32> {
    let to = look_parameters.sky;
    return vec3<f32>(dot(axis, to.right), dot(axis, to.forward), dot(axis, to.up));
}

/// The angle about the up axis, from 0 to 1.
fn sky_turns(own: vec3<f32>) -> f32 {
    return atan2(own.x, own.y) / (2.0 * SKY_PI) + 0.5;
}

fn sky_number(i: u32) -> vec2<u32> {
    return vec2<u32>(i % SKY_ROW, i / SKY_ROW);
}

fn sky_texel(x: i32, y: i32) -> vec3<f32> {
    let width = i32(look_parameters.sky.width);
    let height = i32(look_parameters.sky.height);
    let column = select(x, select(x - width, x + width, x < 0), x < 0 || x >= width);
    let at = 2u * u32(clamp(y, 0, height - 1) * width + column);
    let low = textureLoad(sky_texels, sky_number(at), 0).x;
    let high = textureLoad(sky_texels, sky_number(at + 1u), 0).x;
    let c = vec3<f32>(vec3<u32>(low & 0xffffu, low >> 16u, high & 0xffffu));
    // In two parts, as one of them may be too large or small for a number.
    let exponent = i32(high >> 16u) - SKY_EXPONENT;
    return ldexp(ldexp(c, vec3<i32>(exponent / 2)), vec3<i32>(exponent - exponent / 2));
}

fn sky(axis: vec3<f32>) -> vec3<f32> {
    let own = sky_own(axis);
    let down = atan2(length(own.xy), own.z) / SKY_PI;
    let x = sky_turns(own) * f32(look_parameters.sky.width) - 0.5;
    let y = down * f32(look_parameters.sky.height) - 0.5;
    let i = i32(floor(x));
    let j = i32(floor(y));
    let f = vec2<f32>(x - floor(x), y - floor(y));
    let first = mix(sky_texel(i, j), sky_texel(i + 1, j), f.x);
    let second = mix(sky_texel(i, j + 1), sky_texel(i + 1, j + 1), f.x);
    return look_parameters.sky.strength * mix(first, second, f.y);
}

/// A file has its own halo.
fn sky_halo(axis: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(0.0);
}

/// Radiance that comes from the sky to a surface.
fn sky_light(axis: vec3<f32>) -> vec3<f32> {
    return look.fill * sky(axis);
}

/// Radiance of a white wall that faces a direction under the whole half space, which is also that of
/// fog in that direction.
fn sky_haze(axis: vec3<f32>) -> vec3<f32> {
    let n = sky_own(axis);
    let bands = look_parameters.sky.bands;
    var c = bands[0].xyz + bands[1].xyz * n.x + bands[2].xyz * n.y + bands[3].xyz * n.z;
    c += bands[4].xyz * (n.x * n.y) + bands[5].xyz * (n.y * n.z);
    c += bands[6].xyz * (3.0 * n.z * n.z - 1.0) + bands[7].xyz * (n.x * n.z);
    c += bands[8].xyz * (n.x * n.x - n.y * n.y);
    return look_parameters.sky.strength * max(c, vec3<f32>(0.0));
}

fn sky_ambient(normal: vec3<f32>) -> vec3<f32> {
    return look.fill * sky_haze(normal);
}

fn sky_word(cell: u32, word: u32) -> u32 {
    return textureLoad(sky_cells, sky_number(3u * cell + word), 0).x;
}

/// A sample of the sky's directions, and its probability density per steradian.
fn sky_toward(cell: vec2<f32>, pair: vec2<f32>) -> vec4<f32> {
    let count = SKY_CELLS.x * SKY_CELLS.y;
    var i = min(u32(cell.x * f32(count)), count - 1u);
    if cell.y >= bitcast<f32>(sky_word(i, 0u)) {
        i = sky_word(i, 1u);
    }
    let at = (vec2<f32>(vec2<u32>(i % SKY_CELLS.x, i / SKY_CELLS.x)) + pair) / vec2<f32>(SKY_CELLS);
    let z = 1.0 - 2.0 * at.y;
    let angle = 2.0 * SKY_PI * (at.x - 0.5);
    let across = sqrt(max(1.0 - z * z, 0.0)) * vec2<f32>(sin(angle), cos(angle));
    let to = look_parameters.sky;
    let axis = across.x * to.right + across.y * to.forward + z * to.up;
    return vec4<f32>(axis, bitcast<f32>(sky_word(i, 2u)));
}

/// The probability density of `sky_toward` in a direction.
fn sky_density(axis: vec3<f32>) -> f32 {
    let own = sky_own(axis);
    let at = vec2<f32>(sky_turns(own), 0.5 - 0.5 * own.z) * vec2<f32>(SKY_CELLS);
    let cell = min(vec2<u32>(max(at, vec2<f32>(0.0))), SKY_CELLS - 1u);
    return bitcast<f32>(sky_word(cell.y * SKY_CELLS.x + cell.x, 2u));
}
