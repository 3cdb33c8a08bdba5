// The camera: the ray of a pixel and the cone of a cell (docs/method.md, 1). A projection's file
// is joined to this one. It has `view_through`, the ray through a place, and `view_over`, the cone
// over the places of a cell.
//
// Indices are those of the full image, even if only a block of it is rendered, so a pixel has
// the same bits in any block. Origins are relative to the eye; only scenes add the eye.

struct ViewUniform {
    right: vec3<f32>,
    /// A pixel's height in the image plane at distance 1, or in radians.
    pixel: f32,
    up: vec3<f32>,
    /// Added to every cone's chord: the rounding of two directions.
    slack: f32,
    forward: vec3<f32>,
    /// How far rays of a pixel go from its centre, in pixels.
    filter_radius: f32,
    /// Width and height of the full image in pixels.
    size: vec2<u32>,
    /// The footprint at distance 1 along the view axis; of parallel rays, at any distance.
    grain: f32,
    /// Radius of the lens, 0 for none, and distance to the plane that is sharp.
    lens: f32,
    focus: f32,
    /// Added to the chords of cones, as rays start all over the lens.
    spread: f32,
    /// Blades of the lens; 0 if it is round.
    blades: u32,
    /// A pixel's width: of parallel rays a length, else as its height.
    across: f32,
    /// The point of the image plane at distance 1 in the middle of the image.
    shift: vec2<f32>,
    unused: vec2<u32>,
}

/// A bundle of rays. At distance t they lie within `r0 + k t` of the axis, and the footprint,
/// half a pixel's width, is `grain0 + grain t`.
struct Beam {
    origin: vec3<f32>,
    axis: vec3<f32>,
    r0: f32,
    k: f32,
    grain0: f32,
    grain: f32,
}

@group(1) @binding(0) var<storage, read> view_parameters: ViewUniform;
var<private> view: ViewUniform;

fn view_load() {
    view = view_parameters;
}

/// The footprint at distance t along the beam.
fn footprint(beam: Beam, t: f32) -> f32 {
    return beam.grain0 + beam.grain * t;
}

/// The ray through the centre of a pixel: k = 0.
fn view_ray(pixel: vec2<u32>) -> Beam {
    return view_ray_at(pixel, vec2<f32>(0.5));
}

/// The ray through a place in pixels from the upper left corner of a pixel.
fn view_ray_at(pixel: vec2<u32>, place: vec2<f32>) -> Beam {
    return view_through(vec2<f32>(pixel), place);
}

/// The cone over all rays of the pixels of a cell. The image's border cuts the cell.
fn view_cone(cell: vec2<u32>, divisor: u32) -> Beam {
    let low = cell * divisor;
    let high = min(low + vec2<u32>(divisor), view.size);
    let middle = vec2<f32>(0.5 * f32(low.x + high.x), 0.5 * f32(low.y + high.y));
    return view_over(middle, vec2<f32>(high - low - vec2<u32>(1u)) + 2.0 * view.filter_radius);
}
