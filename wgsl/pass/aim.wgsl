// Rays to points of a light.

/// A unit direction to a point of a light, uniform over a disc across it.
fn aim(lamp: Lamp, pair: vec2<f32>) -> vec3<f32> {
    let across = lamp.softness * sqrt(pair.y) * material_turn(pair.x);
    return normalize(material_frame(lamp.axis) * vec3<f32>(across, 1.0));
}

/// The purpose of the random numbers of a light, where the sun is the first and lamps follow. Each
/// bounce has four, for the sun, the first lamp and the material. Further lamps have those behind:
/// 68 and more, as there are at most 16 bounces.
fn aim_purpose(bounce: u32, nth: u32) -> u32 {
    return select(4u * bounce + nth, 66u + 2u * bounce + nth, nth > 1u);
}
