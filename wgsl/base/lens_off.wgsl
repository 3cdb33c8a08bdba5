// Replaces `lens.wgsl` where the lens is a point.

fn view_ray_from(pixel: vec2<u32>, place: vec2<f32>, share: vec2<f32>) -> Beam {
    return view_ray_at(pixel, place);
}
