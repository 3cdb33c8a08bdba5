//! Exponential fog. Twins: `wgsl/pass/fog.wgsl`, `fog_off.wgsl`.

use glam::DVec3;

use crate::base::shader::Module;
use crate::pass::look::Light;
use crate::wgsl;

/// The module to join where there is fog, or none.
pub fn module(on: bool) -> Module {
    if on {
        wgsl!("pass/fog.wgsl")
    } else {
        wgsl!("pass/fog_off.wgsl")
    }
}

/// A colour seen through fog of a length.
pub fn fog(light: &Light, color: DVec3, axis: DVec3, t: f64) -> DVec3 {
    light.sky(axis).lerp(color, (-light.fog * t).exp())
}
