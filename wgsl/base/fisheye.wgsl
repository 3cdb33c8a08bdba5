// The fisheye projection: the angle to the view axis is proportional to the distance from the
// middle of the image (equidistant). Places beyond 180 degrees all look straight back.

/// The direction through a point of the image, given in pixels from the upper left corner.
fn view_direction(x: f32, y: f32) -> vec3<f32> {
    let a = vec2<f32>(x - 0.5 * f32(view.size.x), 0.5 * f32(view.size.y) - y) * view.pixel;
    // The square of pi.
    let parts = angle_parts(0.25 * min(dot(a, a), 9.869604));
    let u = parts.x * view.forward + parts.y * (a.x * view.right + a.y * view.up);
    return u / length(u);
}

/// The ray through a place in pixels from the upper left corner of a pixel.
fn view_through(corner: vec2<f32>, place: vec2<f32>) -> Beam {
    let axis = view_direction(corner.x + place.x, corner.y + place.y);
    return Beam(vec3<f32>(0.0), axis, 0.0, 0.0, 0.0, view.grain);
}

/// The cone over the places of a cell, given by their middle and their span in pixels. Two
/// directions are no farther apart than their places, in radians.
fn view_over(middle: vec2<f32>, span: vec2<f32>) -> Beam {
    let axis = view_direction(middle.x, middle.y);
    let k = min(2.0, 0.5 * view.pixel * length(span) + view.slack);
    return Beam(vec3<f32>(0.0), axis, 0.0, k, 0.0, view.grain);
}
