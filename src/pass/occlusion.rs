//! Ambient occlusion: how much of the sky a point sees.
//! Twins: `wgsl/pass/occlusion.wgsl`, `occlusion_off.wgsl`.

use std::array;

use crate::base::lanes::{LANES, Places};
use crate::pass::LookFeature;
use crate::pass::look::{Light, Place};
use crate::scene::{ROOMS, Solid};

/// Share of the sky that a point sees.
pub fn occlusion<S: Solid>(solid: &S, light: &Light, place: Place) -> f64 {
    occlusions(solid, light, &[place])[0]
}

/// The least of the distances from the surface at which free room is asked for. Each of the others is
/// twice the one before.
pub fn nearest(light: &Light, grain: f64) -> f64 {
    (light.look.occlusion_reach / 16.0).max(2.0 * grain)
}

/// [`occlusion`] for many points.
pub fn occlusions<S: Solid>(solid: &S, light: &Light, places: &[Place]) -> Vec<f64> {
    if !light.has(LookFeature::Occlusion) {
        return vec![1.0; places.len()];
    }
    let open = |(place, rooms): (&Place, [f64; ROOMS])| {
        let (mut open, mut h) = (1.0, nearest(light, place.grain));
        for room in rooms {
            let free = (room / h).clamp(0.0, 1.0);
            open *= 1.0 - 0.4 * light.look.occlusion * (1.0 - free).powi(2);
            h *= 2.0;
        }
        open
    };
    let parts = places.chunks(LANES).flat_map(|part| {
        let of = |i: usize| part.get(i).unwrap_or(&part[0]);
        let at = Places {
            points: array::from_fn(|i| of(i).q),
            on: array::from_fn(|i| i < part.len()),
        };
        let axes = array::from_fn(|i| of(i).normal);
        let rooms = solid.rooms_lanes(&at, &axes, &array::from_fn(|i| nearest(light, of(i).grain)));
        part.iter().zip(rooms)
    });
    parts.map(open).collect()
}
