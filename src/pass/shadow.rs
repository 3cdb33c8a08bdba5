//! The shadow of a light: whether a ray from the point to the light meets a surface.
//! Twins: `wgsl/pass/shadow.wgsl`, `shadow_off.wgsl`.

use crate::base::view::Beam;
use crate::pass::LookFeature;
use crate::pass::follow::{Start, follow_all};
use crate::pass::lamp::Lamp;
use crate::pass::look::{Light, Place};
use crate::scene::{Solid, Step};

/// What a shadow ray found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// Share of the light that arrives: 0 or 1.
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

/// Follows a ray from a point to the light.
pub fn shadow<S: Solid>(of: (&S, &Light), place: Place, lamp: &Lamp) -> Shadow {
    shadows(of, &[(place, *lamp)])[0]
}

/// [`shadow`] for many points with their lamps.
pub fn shadows<S: Solid>((solid, light): (&S, &Light), all: &[(Place, Lamp)]) -> Vec<Shadow> {
    if !light.has(LookFeature::Shadow) {
        return vec![Shadow::NONE; all.len()];
    }
    let start = |(place, lamp): &(Place, Lamp)| Start {
        ray: Beam {
            origin: place.q + solid.shadow_lift(place.grain) * place.normal,
            axis: lamp.axis,
            r0: 0.0,
            k: 0.0,
            grain0: place.grain,
            grain: 0.0,
        },
        front: 0.0,
        far: lamp.far,
    };
    let starts: Vec<Start> = all.iter().map(start).collect();
    let ends = follow_all(solid, &starts, light.shadow_steps);
    let shadow = |step: Step| Shadow {
        open: f64::from(u8::from(step != Step::Hit)),
        decided: matches!(step, Step::Hit | Step::Out),
    };
    ends.iter().map(|end| shadow(end.step)).collect()
}
