//! Exponential fog. Twins: `wgsl/pass/fog.wgsl`, `fog_off.wgsl`.

use glam::DVec3;

use crate::base::view::Beam;
use crate::pass::LookFeature;
use crate::pass::fog_height::fog_depth;
use crate::pass::look::Light;

/// A colour that is seen through `t` units of fog along a ray.
pub fn fog(light: &Light, color: DVec3, ray: &Beam, t: f64) -> DVec3 {
    if !light.has(LookFeature::Fog) {
        return color;
    }
    let depth = fog_depth(light, ray, t);
    light.sky_haze(ray.axis).lerp(color, (-depth).exp())
}
