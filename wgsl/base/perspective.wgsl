// The perspective projection: rays go from the eye through an even image plane.

/// The direction through a point of the image, given in pixels from the upper left corner. Its
/// length is not 1.
fn view_direction(x: f32, y: f32) -> vec3<f32> {
    let sx = (x - 0.5 * f32(view.size.x)) * view.pixel + view.shift.x;
    let sy = (0.5 * f32(view.size.y) - y) * view.pixel + view.shift.y;
    return view.forward + sx * view.right + sy * view.up;
}

/// The ray through a place in pixels from the upper left corner of a pixel.
fn view_through(corner: vec2<f32>, place: vec2<f32>) -> Beam {
    let u = view_direction(corner.x + place.x, corner.y + place.y);
    let n = length(u);
    return Beam(vec3<f32>(0.0), u / n, 0.0, 0.0, 0.0, view.grain / n);
}

/// The cone over the places of a cell, given by their middle and their span in pixels.
///
/// The chord k is at most `2|h| / (2|u| - |h|)`, where h is half the diagonal. This bound is
/// free of cancellation. The grain is that of the coarsest pixel in the cell.
fn view_over(middle: vec2<f32>, span: vec2<f32>) -> Beam {
    let u = view_direction(middle.x, middle.y);
    let n = length(u);
    let h = 0.5 * view.pixel * length(span);
    var k = 2.0;
    if h < n {
        k = min(2.0, 2.0 * h / (2.0 * n - h) + view.slack + view.spread);
    }
    // |u| >= 1 for every ray, as the image plane is at distance 1.
    let nearest = max(1.0, n - h);
    return Beam(vec3<f32>(0.0), u / n, 1.000001 * view.lens, k, 0.0, view.grain / nearest);
}
