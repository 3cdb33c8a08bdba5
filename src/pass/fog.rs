//! Exponential fog. Twins: `wgsl/pass/fog.wgsl`, `fog_off.wgsl`.

use glam::DVec3;

use crate::pass::LookFeature;
use crate::pass::look::Light;

/// A colour seen through fog of a length.
pub fn fog(light: &Light, color: DVec3, axis: DVec3, t: f64) -> DVec3 {
    if !light.has(LookFeature::Fog) {
        return color;
    }
    light.sky(axis).lerp(color, (-light.fog * t).exp())
}
