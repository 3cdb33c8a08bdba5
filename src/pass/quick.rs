//! Light by formulas: key light with a soft shadow, and light from the sky and from the ground with
//! occlusion. Twin: `wgsl/pass/quick.wgsl`.

use glam::DVec3;

use crate::base::view::{Beam, footprint};
use crate::pass::color::albedo_of;
use crate::pass::emission::emission;
use crate::pass::lamp::{lamp_from, lamp_light};
use crate::pass::look::Light;
use crate::pass::occlusion;
use crate::pass::shadow::{self, Shadow};
use crate::scene::{Solid, Surface};

/// Radiance that leaves a surface towards the eye, and whether the shadow ray reached its end.
pub fn shade<S: Solid>(
    solid: &S,
    light: &Light,
    ray: &Beam,
    t: f64,
    surface: &Surface,
) -> (DVec3, bool) {
    let (q, grain) = (ray.at(t), footprint(ray, t));
    let (n, look) = (surface.normal, &light.look);
    let albedo = albedo_of(solid, light, surface, q);
    let facing = n.dot(look.light);
    // A surface that faces away is dark: it needs no shadow ray.
    let sun = light.sun(solid.bounds_far());
    let key = if facing > 0.0 {
        shadow::shadow((solid, light), q, n, grain, &sun)
    } else {
        Shadow::NONE
    };
    let lit = facing.max(0.0) * key.open;
    let open = occlusion::occlusion(solid, light, q, n, grain);
    let up = 0.5 + 0.5 * n.dot(light.world_up);
    let ambient = light.sky_ambient(n);
    // Light from lit neighbours: warm, from below.
    let bounce = look.light_color * (0.12 * look.fill * (1.0 - up));
    let half_way = (look.light - ray.axis).normalize_or_zero();
    let shine = n.dot(half_way).max(0.0).powi(40);
    let mut decided = key.decided;
    let mut c = albedo * (look.light_color * (look.key * lit) + (ambient + bounce) * open)
        + look.light_color * (look.gloss * lit * shine);
    for nth in 0..light.lamps.len() {
        let lamp = lamp_from(light, nth, q);
        let (to_lamp, strength) = (n.dot(lamp.axis), lamp_light(light, nth, &lamp));
        if to_lamp <= 0.0 || strength == DVec3::ZERO {
            continue;
        }
        let near = shadow::shadow((solid, light), q, n, grain, &lamp);
        c += albedo * (to_lamp * near.open) * strength;
        decided &= near.decided;
    }
    (c + emission(solid, light, surface), decided)
}
