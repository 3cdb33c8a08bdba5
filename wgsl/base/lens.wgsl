// Rays that start all over a lens (docs/method.md, 1).

/// Two numbers from 0 to 1 that look random, for each pixel.
fn view_hash(pixel: vec2<u32>) -> vec2<f32> {
    const BY = 1664525u;
    var v = pixel * BY + 1013904223u;
    for (var i = 0u; i < 2u; i++) {
        v.x += v.y * BY;
        v.y += v.x * BY;
        v ^= v >> vec2<u32>(16u);
    }
    return vec2<f32>(v >> vec2<u32>(8u)) / 16777216.0;
}

fn view_corner(turn: f32) -> vec2<f32> {
    return vec2<f32>(cos(6.2831853 * turn), sin(6.2831853 * turn));
}

/// The point of the unit lens at a share of it along the circumference and along the radius.
fn view_lens_point(share: vec2<f32>) -> vec2<f32> {
    if view.blades == 0u {
        return sqrt(share.y) * view_corner(share.x);
    }
    let blades = f32(view.blades);
    let at = share.x * blades;
    let one = view_corner(floor(at) / blades);
    let two = view_corner((floor(at) + 1.0) / blades);
    return sqrt(share.y) * mix(one, two, fract(at));
}

/// The same ray from a point of the lens. `share` is the place of the point, uniform from 0 to 1
/// along both axes; each pixel shifts it. Below 0 it is the centre.
fn view_ray_from(pixel: vec2<u32>, place: vec2<f32>, share: vec2<f32>) -> Beam {
    var ray = view_ray_at(pixel, place);
    if share.x >= 0.0 {
        let point = view.lens * view_lens_point(fract(share + view_hash(pixel)));
        let aside = point.x * view.right + point.y * view.up;
        // All rays of a place meet in the plane of the focus.
        ray.axis = normalize(view.focus / dot(ray.axis, view.forward) * ray.axis - aside);
        ray.origin += aside;
    }
    return ray;
}
