//! Sun shafts: light of the sun that fog scatters toward the eye once, by one point and one shadow ray
//! for each sample. Twins: `wgsl/pass/shafts.wgsl`, `shafts_off.wgsl`.
//!
//! Fog blends a colour toward the sky, whose wide halo about the sun stands for this light. Here
//! the halo is taken out of the fog, and what the sun sends to the points of the ray takes its place:
//! the integral of `s exp(-f) J V` over the way, where f is the depth of the fog, s its slope, J the
//! radiance that a lit point adds, and V whether the sun is seen from there. The sky behind keeps its
//! halo. Sunlight reaches the fog undimmed, and only the first scattering counts.

use std::f64::consts::PI;

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use crate::base::random::{random_pair, random_seed};
use crate::base::view::{Beam, footprint};
use crate::pass::LookFeature;
use crate::pass::aim::aim;
use crate::pass::fog_height::fog_depth;
use crate::pass::look::Light;
use crate::pass::path::path_sight;
use crate::plan::look::Look;
use crate::scene::{Solid, Step};

/// How far fog scatters forward: the mean cosine of Henyey and Greenstein (1941).
const SHAFTS_FORWARD: f64 = 0.6;
/// The purposes of the random numbers: those of paths are below 128, or above 129.
pub(super) const SHAFTS_PURPOSE: u32 = 128;
/// Halvings of the way: what is left is less than its rounding in f32.
const SHAFTS_HALVINGS: u32 = 24;
/// A ray from the fog to the sun has at most this part of the steps of a path.
pub(super) const SHAFTS_STEPS: u32 = 4;

/// The shafts as WGSL reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ShaftsUniform {
    /// What lit fog scatters into all directions together.
    pub light: Vec3,
    /// Step limit of a ray from the fog to the sun.
    pub steps: u32,
}

/// What lit fog scatters into all directions together. A white wall that faces a light of the
/// strength 1 has the radiance 1, so pi meets it.
pub fn shafts_light(look: &Look) -> DVec3 {
    match LookFeature::Shafts.is_on(look) {
        true => look.shafts * PI * look.key * look.light_color,
        false => DVec3::ZERO,
    }
}

/// The share of light that fog scatters into a direction, per steradian, for the cosine of the
/// angle by which it turns.
fn shafts_phase(cosine: f64) -> f64 {
    let g = SHAFTS_FORWARD;
    let away = 1.0 + g * g - 2.0 * g * cosine;
    (1.0 - g * g) / (4.0 * PI * away * away.sqrt())
}

/// How far a ray goes through fog of a depth, which is at most that of `end`.
fn shafts_way(light: &Light, ray: &Beam, end: f64, depth: f64) -> f64 {
    let (mut low, mut high) = (0.0, end);
    for _ in 0..SHAFTS_HALVINGS {
        let middle = 0.5 * (low + high);
        match fog_depth(light, ray, middle) < depth {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

/// A colour behind `end` units of fog that has its share of the sky, with shafts in place of the halo;
/// and whether the ray to the sun reached its end.
pub fn shafts<S: Solid>(
    (solid, light): (&S, &Light),
    (pixel, before): ([u32; 2], u32),
    color: DVec3,
    ray: &Beam,
    end: f64,
) -> (DVec3, bool) {
    let full = shafts_light(&light.look);
    if full == DVec3::ZERO {
        return (color, true);
    }
    let share = 1.0 - (-fog_depth(light, ray, end)).exp();
    let (seed, sun) = (random_seed(pixel), light.sun(solid.bounds_far()));
    let pair = |nth| random_pair(seed, before, SHAFTS_PURPOSE + nth);
    let (at, toward) = match light.discs {
        true => (pair(0).x, aim(&sun, pair(1))),
        // A picture without noise: the middle of the fog and of the sun.
        false => (0.5, sun.axis),
    };
    let t = shafts_way(light, ray, end, -(1.0 - at * share).ln());
    let to = Beam {
        origin: ray.at(t),
        axis: toward,
        r0: 0.0,
        k: 0.0,
        grain0: footprint(ray, t),
        grain: 0.0,
    };
    let mut steps = light.shafts_steps;
    let (step, _) = path_sight((solid, light), &to, sun.far, &mut steps);
    let mut c = color - share * light.halo(ray.axis);
    if step == Step::Out {
        c += share * shafts_phase(ray.axis.dot(light.look.light)) * full;
    }
    // The difference may round below nothing.
    (c.max(DVec3::ZERO), matches!(step, Step::Hit | Step::Out))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fog_scatters_into_all_directions_is_all_of_it() {
        const PARTS: u32 = 10_000;
        let one = |i: u32| shafts_phase(2.0 * (f64::from(i) + 0.5) / f64::from(PARTS) - 1.0);
        let cosine = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(PARTS) - 1.0;
        let mean =
            |of: &dyn Fn(u32) -> f64| (0..PARTS).map(of).sum::<f64>() * 4.0 * PI / f64::from(PARTS);
        assert!((mean(&one) - 1.0).abs() < 1e-6);
        assert!((mean(&|i| one(i) * cosine(i)) - SHAFTS_FORWARD).abs() < 1e-6);
    }
}
