//! The soft shadow of the key light. Twins: `wgsl/pass/shadow.wgsl`, `shadow_off.wgsl`.

use glam::DVec3;

use super::look::{Light, smoothstep};
use crate::frame::Work;
use crate::scene::{Solid, Step};
use crate::shader::Module;
use crate::view::Beam;
use crate::wgsl;

/// The module to join where shadows are cast, or not.
pub fn module(on: bool) -> Module {
    if on {
        wgsl!("pass/shadow.wgsl")
    } else {
        wgsl!("pass/shadow_off.wgsl")
    }
}

/// Share of the light that reaches a point: 0 behind any hit, else by the narrowest
/// empty ball on the way, as wide as the light seen from the point.
pub fn shadow<S: Solid>(solid: &S, light: &Light, q: DVec3, normal: DVec3, grain: f64) -> f64 {
    let ray = Beam {
        // Start off the surface, or its own hit shell would shade it.
        origin: q + 4.0 * grain * normal,
        axis: light.light,
        r0: 0.0,
        k: 0.0,
        grain0: grain,
        grain: 0.0,
    };
    let work = &mut Work::default();
    let mut walk = solid.begin(&ray, 0.0, 2.0 * solid.bounds_far(), work);
    let mut open = 1.0_f64;
    for _ in 0..light.shadow_steps {
        match solid.walk_step(&ray, &mut walk, work) {
            Step::Out | Step::Spent => break,
            Step::Hit => return 0.0,
            Step::Moving => {}
        }
        let t = solid.walk_hit(&walk).t;
        if t > 4.0 * grain {
            open = open.min(solid.walk_radius(&ray, &walk) / (light.softness * t));
        }
    }
    smoothstep(0.0, 1.0, open)
}
