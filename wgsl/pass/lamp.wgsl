// The light of a lamp in the scene: a small ball that shines evenly, weaker by the square of the
// distance.

/// The lamp as a point sees it.
fn lamp_from(q: vec3<f32>) -> Lamp {
    // A program may be kept when the number becomes zero.
    if all(look.lamp == vec3<f32>(0.0)) {
        return Lamp(vec3<f32>(0.0), 1.0, 0.0);
    }
    let way = look.lamp_at - q;
    // Not inside it.
    let off = length(way);
    let far = max(off, look.lamp_size);
    return Lamp(select(way / off, look.world_up, off < 1e-20), far, look.lamp_size / far);
}

/// Radiance of a white wall that faces the lamp at a distance.
fn lamp_light(far: f32) -> vec3<f32> {
    return look.lamp / (far * far);
}
