//! Ambient occlusion: how much of the sky a point sees.
//! Twins: `wgsl/pass/occlusion.wgsl`, `occlusion_off.wgsl`.

use glam::DVec3;

use crate::pass::LookFeature;
use crate::pass::look::Light;
use crate::scene::Solid;

/// Share of the sky that a point sees. `grain` is half a pixel's width there.
pub fn occlusion<S: Solid>(solid: &S, light: &Light, q: DVec3, normal: DVec3, grain: f64) -> f64 {
    let mut open = 1.0;
    if !light.has(LookFeature::Occlusion) {
        return open;
    }
    let mut h = (light.look.occlusion_reach / 16.0).max(2.0 * grain);
    for room in solid.rooms(q, normal, h) {
        let free = (room / h).clamp(0.0, 1.0);
        open *= 1.0 - 0.4 * light.look.occlusion * (1.0 - free).powi(2);
        h *= 2.0;
    }
    open
}
