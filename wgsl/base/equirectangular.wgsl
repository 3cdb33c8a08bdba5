// The equirectangular projection: longitude from left to right, latitude upward, all about the eye.

/// A distance from the middle of the image, less whole turns, in pixels.
fn view_wrapped(x: f32, turn: f32) -> f32 {
    return x - turn * round(x / turn);
}

/// The direction through a point of the image, given in pixels from the upper left corner. Places
/// beyond a pole are on its other side.
fn view_direction(x: f32, y: f32) -> vec3<f32> {
    let size = vec2<f32>(view.size);
    let longitude = angle_turn(view.across * view_wrapped(x - 0.5 * size.x, size.x));
    let latitude = angle_turn(view.pixel * view_wrapped(0.5 * size.y - y, 2.0 * size.y));
    let level = longitude.x * view.forward + longitude.y * view.right;
    let u = latitude.x * level + latitude.y * view.up;
    return u / length(u);
}

/// The ray through a place in pixels from the upper left corner of a pixel.
fn view_through(corner: vec2<f32>, place: vec2<f32>) -> Beam {
    let axis = view_direction(corner.x + place.x, corner.y + place.y);
    return Beam(vec3<f32>(0.0), axis, 0.0, 0.0, 0.0, view.grain);
}

/// The cone over the places of a cell, given by their middle and their span in pixels. On the way
/// from the middle to a place, circles of latitude are as long as at the least latitude at most.
fn view_over(middle: vec2<f32>, span: vec2<f32>) -> Beam {
    let axis = view_direction(middle.x, middle.y);
    let half = 0.5 * span * vec2<f32>(view.across, view.pixel);
    let latitude = abs(0.5 * f32(view.size.y) - middle.y) * view.pixel;
    let widest = angle_turn(max(0.0, latitude - half.y)).x;
    let k = min(2.0, length(vec2<f32>(widest * half.x, half.y)) * 1.000001 + view.slack);
    return Beam(vec3<f32>(0.0), axis, 0.0, k, 0.0, view.grain);
}
