//! Ambient occlusion. Twins: `wgsl/pass/occlusion.wgsl`, `occlusion_off.wgsl`.

use glam::DVec3;

use crate::pass::LookFeature;
use crate::pass::look::Light;
use crate::scene::Solid;

/// Probes along the normal, at distances doubling up to the reach.
const OCCLUSION_TAPS: u32 = 5;

/// Share of the sky that a point sees.
pub fn occlusion<S: Solid>(solid: &S, light: &Light, q: DVec3, normal: DVec3, grain: f64) -> f64 {
    let mut open = 1.0;
    if !light.has(LookFeature::Occlusion) {
        return open;
    }
    let mut h = (light.occlusion_reach / 16.0).max(2.0 * grain);
    for _ in 0..OCCLUSION_TAPS {
        let free = (solid.room(q + h * normal) / h).clamp(0.0, 1.0);
        open *= 1.0 - 0.4 * light.occlusion_strength * (1.0 - free).powi(2);
        h *= 2.0;
    }
    open
}
