//! The soft shadow of a light. A ray goes from the point to the light: a hit is full
//! shadow, and the narrowest empty ball on the way gives the penumbra.
//! Twins: `wgsl/pass/shadow.wgsl`, `shadow_off.wgsl`.

use glam::DVec3;

use crate::base::outcome::Counts;
use crate::base::view::Beam;
use crate::pass::LookFeature;
use crate::pass::lamp::Lamp;
use crate::pass::look::{Light, smoothstep};
use crate::scene::{Solid, Step};

/// What a shadow ray found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Share of the light that arrives, as far as the ray came.
    pub open: f64,
    /// Whether the ray reached its end before its step limit.
    pub decided: bool,
}

impl Shadow {
    /// Full light.
    pub const NONE: Self = Self {
        open: 1.0,
        decided: true,
    };
}

/// Follows a ray from a point to the light. `grain` is half a pixel's width at the point.
pub fn shadow<S: Solid>(
    (solid, light): (&S, &Light),
    q: DVec3,
    normal: DVec3,
    grain: f64,
    lamp: &Lamp,
) -> Shadow {
    if !light.has(LookFeature::Shadow) {
        return Shadow::NONE;
    }
    let ray = Beam {
        origin: q + solid.shadow_lift(grain) * normal,
        axis: lamp.axis,
        r0: 0.0,
        k: 0.0,
        grain0: grain,
        grain: 0.0,
    };
    let work = &mut Counts::default();
    let mut walk = solid.begin(&ray, 0.0, lamp.far, work);
    let mut open = 1.0_f64;
    let mut decided = false;
    for _ in 0..light.shadow_steps {
        let step = solid.walk_step(&ray, &mut walk, work);
        decided = matches!(step, Step::Hit | Step::Out);
        if step == Step::Hit {
            open = 0.0;
        }
        if step != Step::Moving {
            break;
        }
        let t = solid.walk_hit(&walk).t;
        if t > 4.0 * grain {
            open = open.min(solid.walk_radius(&ray, &walk) / (lamp.softness * t));
        }
    }
    Shadow {
        open: smoothstep(0.0, 1.0, open),
        decided,
    }
}
