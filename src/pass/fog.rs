//! Exponential fog. Twins: `wgsl/pass/fog.wgsl`, `fog_off.wgsl`.

use glam::DVec3;

use crate::pass::LookFeature;
use crate::pass::look::Light;

/// A colour that is seen through `t` units of fog along a ray.
pub fn fog(light: &Light, color: DVec3, axis: DVec3, t: f64) -> DVec3 {
    if !light.has(LookFeature::Fog) {
        return color;
    }
    light.sky(axis).lerp(color, (-light.look.fog * t).exp())
}
