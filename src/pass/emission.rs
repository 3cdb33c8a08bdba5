//! Light that the surface itself sends out, where the orbit comes near a trap.
//! Twins: `wgsl/pass/emission.wgsl`, `emission_off.wgsl`.

use glam::DVec3;

use crate::pass::LookFeature;
use crate::pass::look::Light;
use crate::scene::{Solid, Surface};

/// Radiance of the surface's own.
pub fn emission<S: Solid>(solid: &S, light: &Light, surface: &Surface) -> DVec3 {
    // A linear colour is no trap.
    if !light.has(LookFeature::Emission) || solid.is_colored() {
        return DVec3::ZERO;
    }
    let look = &light.look;
    let trap = surface.pigment[look.emission_trap as usize];
    let near = (1.0 - trap / look.emission_width).max(0.0);
    look.emission * look.emission_color * (near * near)
}
