//! Light by formulas: the sun and lamps with a shadow ray each, and light from the sky and from the
//! ground with occlusion. Twins: `wgsl/pass/quick.wgsl`, `quick_lamps.wgsl`, `quick_lamps_off.wgsl`.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::base::random::{random_pair, random_seed};
use crate::base::view::{Beam, footprint};
use crate::pass::aim::{aim, aim_purpose};
use crate::pass::color::albedo_of;
use crate::pass::emission::emission;
use crate::pass::lamp::{Lamp, lamp_from, lamp_light};
use crate::pass::look::{Light, Place};
use crate::pass::material::{Material, material_frame, material_view};
use crate::pass::occlusion::occlusions;
use crate::pass::shadow::{self, Shadow};
use crate::scene::{Solid, Surface};

/// A surface that a ray met.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The pixel of the ray.
    pub pixel: [u32; 2],
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

/// The material of a surface as the eye sees it.
struct Skin {
    /// From the frame of the surface to the world.
    frame: DMat3,
    /// To the eye, in that frame.
    v: DVec3,
    material: Material,
}

impl Skin {
    fn of<S: Solid>(solid: &S, light: &Light, spot: &Spot, place: &Place) -> Self {
        let frame = material_frame(place.normal);
        let v = material_view(frame.transpose() * -spot.ray.axis);
        let albedo = albedo_of(solid, light, &spot.surface, place.q).min(DVec3::ONE);
        Self {
            frame,
            v,
            material: light.substance.material_at(albedo, v),
        }
    }

    /// The radiance towards the eye of a light in which a white wall has radiance 1. `radius` is the
    /// tangent of its angular radius.
    fn reflects(&self, light: &Light, toward: DVec3, radius: f64) -> DVec3 {
        let l = self.frame.transpose() * toward;
        if l.z <= 0.0 {
            return DVec3::ZERO;
        }
        let of = &light.substance;
        let (share, _) = of.material_reflects(&self.material, self.v, l, radius);
        PI * share
    }
}

/// Radiance that leaves surfaces towards the eye, and whether the shadow rays reached their ends.
/// `before` is the number of the pixels' samples before this one.
pub fn shade<S: Solid>(
    (solid, light): (&S, &Light),
    before: u32,
    spots: &[Spot],
) -> Vec<(DVec3, bool)> {
    let look = &light.look;
    let places: Vec<Place> = spots.iter().map(Spot::place).collect();
    // A surface that faces away is dark: it needs no shadow ray.
    let sun = light.sun(solid.bounds_far());
    let facing = |place: &Place| place.normal.dot(look.light);
    let keys = shadows_of((solid, light), &places, |i, place| {
        (facing(place) > 0.0).then(|| quick_lamp(light, &sun, 0, &spots[i], before))
    });
    let opens = occlusions(solid, light, &places);
    let skins: Vec<Skin> = spots
        .iter()
        .zip(&places)
        .map(|(spot, place)| Skin::of(solid, light, spot, place))
        .collect();
    let unlit = |i: usize| {
        let (n, open, skin) = (places[i].normal, opens[i], &skins[i]);
        let up = 0.5 + 0.5 * n.dot(light.world_up);
        // Light from lit neighbours: warm, from below.
        let bounce = look.light_color * (0.12 * look.fill * (1.0 - up));
        let axis = spots[i].ray.axis;
        let mirrored = light.sky_ambient(axis - 2.0 * axis.dot(n) * n);
        let coated = open.powi(4) * (2.0 * skin.v.z).min(1.0);
        let c = skin.reflects(light, look.light, light.softness)
            * (look.key * keys[i].open)
            * look.light_color
            + skin.material.base * (light.sky_ambient(n) + bounce) * open
            + skin.material.coat * mirrored * coated;
        (c, keys[i].decided)
    };
    let mut all: Vec<(DVec3, bool)> = (0..spots.len()).map(unlit).collect();
    for nth in 0..light.lamps.len() {
        let lit = |place: &Place| {
            let lamp = lamp_from(light, nth, place.q);
            let strength = lamp_light(light, nth, &lamp);
            let lit = place.normal.dot(lamp.axis) > 0.0 && strength != DVec3::ZERO;
            lit.then_some((lamp, strength))
        };
        let lit: Vec<_> = places.iter().map(lit).collect();
        let near = shadows_of((solid, light), &places, |i, place| {
            lit[i]?;
            // Shadow rays start here. The strength is that of the point itself, whatever the size of
            // a pixel.
            let start = place.q + solid.shadow_lift(place.grain) * place.normal;
            let lamp = lamp_from(light, nth, start);
            Some(quick_lamp(light, &lamp, 1 + nth as u32, &spots[i], before))
        });
        for (i, (c, decided)) in all.iter_mut().enumerate() {
            if let Some((lamp, strength)) = lit[i] {
                *c +=
                    skins[i].reflects(light, lamp.axis, lamp.softness) * (near[i].open * strength);
                *decided &= near[i].decided;
            }
        }
    }
    for ((c, _), spot) in all.iter_mut().zip(spots) {
        *c += emission(solid, light, &spot.surface);
    }
    all
}

/// A light as a sample sees it: a point of its disc, the same as at the first hit of a path.
fn quick_lamp(light: &Light, lamp: &Lamp, nth: u32, spot: &Spot, before: u32) -> Lamp {
    match light.discs {
        true => {
            let pair = random_pair(random_seed(spot.pixel), before, aim_purpose(0, nth));
            Lamp {
                axis: aim(lamp, pair),
                ..*lamp
            }
        }
        false => *lamp,
    }
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
