// The orthographic projection: parallel rays start in the plane of the eye.

/// More than the rounding of two origins, in diagonals of the image.
override ORTHOGRAPHIC_SLACK: f32;

/// Where a ray starts, relative to the eye.
fn view_origin(x: f32, y: f32) -> vec3<f32> {
    let sx = (x - 0.5 * f32(view.size.x)) * view.across;
    let sy = (0.5 * f32(view.size.y) - y) * view.across;
    return sx * view.right + sy * view.up;
}

/// The ray through a place in pixels from the upper left corner of a pixel.
fn view_through(corner: vec2<f32>, place: vec2<f32>) -> Beam {
    let origin = view_origin(corner.x + place.x, corner.y + place.y);
    return Beam(origin, view.forward, 0.0, 0.0, view.grain, 0.0);
}

/// The cone over the places of a cell, given by their middle and their span in pixels. Its radius
/// is half the diagonal.
fn view_over(middle: vec2<f32>, span: vec2<f32>) -> Beam {
    let rounding = ORTHOGRAPHIC_SLACK * length(vec2<f32>(view.size));
    let r0 = view.across * (0.5 * length(span) * 1.000001 + rounding) + 1.000001 * view.lens;
    let origin = view_origin(middle.x, middle.y);
    return Beam(origin, view.forward, r0, view.slack + view.spread, view.grain, 0.0);
}
