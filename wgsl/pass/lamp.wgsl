// The light of lamps in the scene: small balls, weaker by the square of the distance, that shine
// evenly or in a cone.

/// How many there are. A program may be kept when there is none.
fn lamp_count() -> u32 {
    return look.lamps;
}

/// A lamp as a point sees it.
fn lamp_from(nth: u32, q: vec3<f32>) -> Lamp {
    let way = look_parameters.lamps[nth].at - q;
    let size = look_parameters.lamps[nth].size;
    // Not inside it.
    let off = length(way);
    let far = max(off, size);
    return Lamp(select(way / off, look.world_up, off < 1e-20), far, size / far);
}

/// Radiance of a white wall that faces the lamp where it is seen so.
fn lamp_light(nth: u32, lamp: Lamp) -> vec3<f32> {
    // What is squared is the distance of two unit vectors.
    let off = lamp.axis + look_parameters.lamps[nth].toward;
    let full = look_parameters.lamps[nth].full;
    let beyond = smoothstep(full, look_parameters.lamps[nth].none, dot(off, off));
    return look_parameters.lamps[nth].light / (lamp.far * lamp.far) * (1.0 - beyond);
}
