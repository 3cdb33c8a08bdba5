//! Light by formulas: key light with a soft shadow, and light from the sky and from the ground with
//! occlusion. Twin: `wgsl/pass/quick.wgsl`.

use glam::DVec3;

use crate::base::view::{Beam, footprint};
use crate::pass::color::albedo_of;
use crate::pass::emission::emission;
use crate::pass::lamp::{Lamp, lamp_from, lamp_light};
use crate::pass::look::{Light, Place};
use crate::pass::occlusion::occlusions;
use crate::pass::shadow::{self, Shadow};
use crate::scene::{Solid, Surface};

/// A surface that a ray met.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The ray.
    pub ray: Beam,
    /// The distance along it.
    pub t: f64,
    /// What is there.
    pub surface: Surface,
}

impl Spot {
    fn place(&self) -> Place {
        Place {
            q: self.ray.at(self.t),
            normal: self.surface.normal,
            grain: footprint(&self.ray, self.t),
        }
    }
}

/// Radiance that leaves surfaces towards the eye, and whether the shadow rays reached their ends.
pub fn shade<S: Solid>(solid: &S, light: &Light, spots: &[Spot]) -> Vec<(DVec3, bool)> {
    let look = &light.look;
    let places: Vec<Place> = spots.iter().map(Spot::place).collect();
    // A surface that faces away is dark: it needs no shadow ray.
    let sun = light.sun(solid.bounds_far());
    let facing = |place: &Place| place.normal.dot(look.light);
    let keys = shadows_of((solid, light), &places, |_, place| {
        (facing(place) > 0.0).then_some(sun)
    });
    let opens = occlusions(solid, light, &places);
    let albedo = |(spot, place): (&Spot, &Place)| albedo_of(solid, light, &spot.surface, place.q);
    let albedos: Vec<DVec3> = spots.iter().zip(&places).map(albedo).collect();
    let unlit = |i: usize| {
        let (n, open, albedo) = (places[i].normal, opens[i], albedos[i]);
        let lit = facing(&places[i]).max(0.0) * keys[i].open;
        let up = 0.5 + 0.5 * n.dot(light.world_up);
        let ambient = light.sky_ambient(n);
        // Light from lit neighbours: warm, from below.
        let bounce = look.light_color * (0.12 * look.fill * (1.0 - up));
        let half_way = (look.light - spots[i].ray.axis).normalize_or_zero();
        let shine = n.dot(half_way).max(0.0).powi(40);
        let c = albedo * (look.light_color * (look.key * lit) + (ambient + bounce) * open)
            + look.light_color * (look.gloss * lit * shine);
        (c, keys[i].decided)
    };
    let mut all: Vec<(DVec3, bool)> = (0..spots.len()).map(unlit).collect();
    for nth in 0..light.lamps.len() {
        let lit = |place: &Place| {
            let lamp = lamp_from(light, nth, place.q);
            let (to_lamp, strength) = (place.normal.dot(lamp.axis), lamp_light(light, nth, &lamp));
            (to_lamp > 0.0 && strength != DVec3::ZERO).then_some((lamp, to_lamp, strength))
        };
        let lit: Vec<_> = places.iter().map(lit).collect();
        let near = shadows_of((solid, light), &places, |i, _| Some(lit[i]?.0));
        for (i, (c, decided)) in all.iter_mut().enumerate() {
            if let Some((_, to_lamp, strength)) = lit[i] {
                *c += albedos[i] * (to_lamp * near[i].open) * strength;
                *decided &= near[i].decided;
            }
        }
    }
    for ((c, _), spot) in all.iter_mut().zip(spots) {
        *c += emission(solid, light, &spot.surface);
    }
    all
}

/// The shadows of points that have a lamp. The others have none.
fn shadows_of<S: Solid>(
    of: (&S, &Light),
    places: &[Place],
    lamp: impl Fn(usize, &Place) -> Option<Lamp>,
) -> Vec<Shadow> {
    let lamps: Vec<Option<Lamp>> = (0..).zip(places).map(|(i, p)| lamp(i, p)).collect();
    let lit = places.iter().zip(&lamps);
    let lit: Vec<_> = lit
        .filter_map(|(place, lamp)| Some((*place, (*lamp)?)))
        .collect();
    let mut shadows = shadow::shadows(of, &lit).into_iter();
    let one = |lamp: &Option<Lamp>| match lamp {
        Some(_) => shadows.next().unwrap_or(Shadow::NONE),
        None => Shadow::NONE,
    };
    lamps.iter().map(one).collect()
}
