//! The soft shadow of the key light. Twins: `wgsl/pass/shadow.wgsl`, `shadow_off.wgsl`.

use glam::DVec3;

use crate::base::view::Beam;
use crate::base::work::Work;
use crate::pass::LookFeature;
use crate::pass::look::{Light, smoothstep};
use crate::scene::{Solid, Step};

/// What a shadow's ray has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Share of the light that arrives, as far as the ray came: 0 behind any hit, else by
    /// the narrowest empty ball on the way, as wide as the light seen from the point.
    pub open: f64,
    /// Whether it came to its end within its steps.
    pub decided: bool,
}

impl Shadow {
    /// Full light.
    pub const NONE: Self = Self {
        open: 1.0,
        decided: true,
    };
}

/// Follows a ray from a point to the light.
pub fn shadow<S: Solid>(solid: &S, light: &Light, q: DVec3, normal: DVec3, grain: f64) -> Shadow {
    if !light.has(LookFeature::Shadow) {
        return Shadow::NONE;
    }
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
    let mut decided = false;
    for _ in 0..light.shadow_steps {
        match solid.walk_step(&ray, &mut walk, work) {
            Step::Hit => {
                return Shadow {
                    open: 0.0,
                    decided: true,
                };
            }
            Step::Out => {
                decided = true;
                break;
            }
            Step::Spent => break,
            Step::Moving => {}
        }
        let t = solid.walk_hit(&walk).t;
        if t > 4.0 * grain {
            open = open.min(solid.walk_radius(&ray, &walk) / (light.softness * t));
        }
    }
    Shadow {
        open: smoothstep(0.0, 1.0, open),
        decided,
    }
}
