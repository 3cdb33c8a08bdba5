//! Ambient occlusion: how much of the sky a point sees.
//! Twins: `wgsl/pass/occlusion.wgsl`, `occlusion_off.wgsl`.

use glam::DVec3;

use crate::pass::LookFeature;
use crate::pass::look::Light;
use crate::scene::Solid;

/// Number of probes along the normal. Their distances double up to the reach.
const OCCLUSION_TAPS: u32 = 5;

/// Share of the sky that a point sees. `grain` is half a pixel's width there.
pub fn occlusion<S: Solid>(solid: &S, light: &Light, q: DVec3, normal: DVec3, grain: f64) -> f64 {
    let mut open = 1.0;
    if !light.has(LookFeature::Occlusion) {
        return open;
    }
    let mut h = (light.look.occlusion_reach / 16.0).max(2.0 * grain);
    for _ in 0..OCCLUSION_TAPS {
        let free = (solid.room(q + h * normal, h) / h).clamp(0.0, 1.0);
        open *= 1.0 - 0.4 * light.look.occlusion * (1.0 - free).powi(2);
        h *= 2.0;
    }
    open
}
