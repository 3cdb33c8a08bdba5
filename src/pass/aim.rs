//! Rays to points of a light. Twin: `wgsl/pass/aim.wgsl`.

use glam::{DVec2, DVec3};

use crate::pass::lamp::Lamp;
use crate::pass::material::{material_frame, material_turn};

/// A unit direction to a point of a light, uniform over a disc across it. The pair is from 0 to 1.
pub fn aim(lamp: &Lamp, pair: DVec2) -> DVec3 {
    let across = lamp.softness * pair.y.sqrt() * material_turn(pair.x);
    (material_frame(lamp.axis) * across.extend(1.0)).normalize()
}

/// The purpose of the random numbers of a light, where the sun is the first and lamps follow. Each
/// bounce has four, for the sun, the first lamp and the material. Further lamps have those behind:
/// 68 and more, as there are at most 16 bounces.
pub fn aim_purpose(bounce: u32, nth: u32) -> u32 {
    match nth {
        0 | 1 => 4 * bounce + nth,
        _ => 66 + 2 * bounce + nth,
    }
}
