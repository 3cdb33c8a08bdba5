//! The light of a lamp in the scene: a small ball that shines evenly, weaker by the square of the
//! distance. Twins: `wgsl/pass/lamp.wgsl`, `lamp_off.wgsl`.

use glam::DVec3;

use crate::pass::LookFeature;
use crate::pass::look::Light;

/// A light as a point sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Unit direction to it.
    pub axis: DVec3,
    /// Its distance.
    pub far: f64,
    /// Tangent of its angular radius.
    pub softness: f64,
}

/// The lamp as a point sees it, if there is one.
pub fn lamp_from(light: &Light, q: DVec3) -> Option<Lamp> {
    let look = &light.look;
    let way = light.lamp_at - q;
    // Not inside it.
    let far = way.length().max(look.lamp_size);
    light.has(LookFeature::Lamp).then_some(Lamp {
        axis: way.normalize_or(light.world_up),
        far,
        softness: look.lamp_size / far,
    })
}

/// Radiance of a white wall that faces the lamp at a distance.
pub fn lamp_light(light: &Light, far: f64) -> DVec3 {
    light.look.lamp * light.look.lamp_color / (far * far)
}
