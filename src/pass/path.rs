//! Light by paths: rays to a point of the sun and of lamps, and a ray in a direction that the material
//! chooses, from surface to surface. The mean over the samples tends to the true light (Kajiya, The
//! rendering equation, 1986). Twin: `wgsl/pass/path.wgsl`.

use std::f64::consts::PI;

use glam::DVec3;

use crate::base::outcome::Counts;
use crate::base::random::{random_pair, random_seed};
use crate::base::view::{Beam, footprint};
use crate::pass::aim::{aim, aim_purpose};
use crate::pass::color::albedo_of;
use crate::pass::emission::emission;
use crate::pass::lamp::{lamp_from, lamp_light};
use crate::pass::look::Light;
use crate::pass::material::{material_frame, material_view};
use crate::scene::{Hit, Solid, Step, Surface};

/// Bounces after which a path may end by chance.
const PATH_SURE: u32 = 2;

/// The first purpose of the random numbers of a sky that is sampled. Each bounce has two. Those of
/// shafts are before it.
const PATH_SKY: u32 = 130;

/// Follows a ray for `reach`. It is neither a hit nor out if it reached a step limit. The path has so many
/// steps left.
pub(super) fn path_sight<S: Solid>(
    (solid, light): (&S, &Light),
    ray: &Beam,
    reach: f64,
    left: &mut u32,
) -> (Step, Hit) {
    let work = &mut Counts::default();
    let mut walk = solid.begin(ray, 0.0, reach, work);
    let mut step = Step::Moving;
    for _ in 0..light.shadow_steps.min(*left) {
        *left -= 1;
        step = solid.walk_step(ray, &mut walk, work);
        if step != Step::Moving {
            break;
        }
    }
    (step, solid.walk_hit(&walk))
}

/// Radiance that leaves a surface towards the eye, by one path, and whether all its rays reached
/// their ends.
pub fn shade<S: Solid>(
    (solid, light): (&S, &Light),
    (pixel, before): ([u32; 2], u32),
    ray: &Beam,
    t: f64,
    surface: &Surface,
) -> (DVec3, bool) {
    let (look, substance) = (&light.look, &light.substance);
    let seed = random_seed(pixel);
    // Half a pixel's width, also for later hits.
    let grain = footprint(ray, t);
    let lift = solid.shadow_lift(grain);
    let far = 2.0 * solid.bounds_far();
    // Without bounces, light of the sky is stopped by near surfaces only.
    let reach = match look.bounces {
        0 => look.occlusion_reach,
        _ => far,
    };
    let (mut sum, mut through) = (DVec3::ZERO, DVec3::ONE);
    let (mut at, mut point, mut axis) = (*surface, ray.at(t), ray.axis);
    let (mut decided, mut left) = (true, light.path_steps);
    for bounce in 0..=look.bounces {
        let frame = material_frame(at.normal);
        let v = material_view(frame.transpose() * -axis);
        let albedo = albedo_of(solid, light, &at, point).min(DVec3::ONE);
        let material = substance.material_at(albedo, v);
        let to = |axis| Beam {
            origin: point + lift * at.normal,
            axis,
            r0: 0.0,
            k: 0.0,
            grain0: grain,
            grain: 0.0,
        };
        sum += through * emission(solid, light, &at);
        let sun = (light.sun(solid.bounds_far()), look.key * look.light_color);
        let lamps = (0..light.lamps.len()).map(|nth| {
            let lamp = lamp_from(light, nth, to(DVec3::Z).origin);
            (lamp, lamp_light(light, nth, &lamp))
        });
        for (nth, (lamp, strength)) in (0..).zip([sun].into_iter().chain(lamps)) {
            let pair = random_pair(seed, before, aim_purpose(bounce, nth));
            let toward = aim(&lamp, pair);
            let l = frame.transpose() * toward;
            if l.z <= 0.0 || strength == DVec3::ZERO {
                continue;
            }
            let (step, _) = path_sight((solid, light), &to(toward), lamp.far, &mut left);
            if step == Step::Out {
                let reflected = substance.material_reflects(&material, v, l, 0.0).0;
                sum += through * reflected * (PI * strength);
            }
            decided &= matches!(step, Step::Hit | Step::Out);
        }
        if let Some(sky) = &light.sky {
            let [place, within] =
                [0, 1].map(|i| random_pair(seed, before, PATH_SKY + 2 * bounce + i));
            let (toward, other) = sky.sky_toward(place, within);
            let l = frame.transpose() * toward;
            if l.z > 0.0 {
                let (step, _) = path_sight((solid, light), &to(toward), reach, &mut left);
                if step == Step::Out {
                    // The balance heuristic (Veach 1997): both rays may find the same light.
                    let (reflected, own) = substance.material_reflects(&material, v, l, 0.0);
                    sum += through * reflected / (other + own) * light.sky_light(toward);
                }
                decided &= matches!(step, Step::Hit | Step::Out);
            }
        }
        let choice = random_pair(seed, before, 4 * bounce + 2);
        let pair = random_pair(seed, before, 4 * bounce + 3);
        let l = substance.material_scatter(&material, v, pair, choice.x);
        if l.z <= 0.0 {
            break;
        }
        let (reflected, density) = substance.material_reflects(&material, v, l, 0.0);
        through *= reflected / density.max(1e-20);
        if bounce >= PATH_SURE {
            let stays = through.max_element().clamp(0.05, 1.0);
            if choice.y >= stays {
                break;
            }
            through /= stays;
        }
        let next = to(frame * l);
        let (step, hit) = path_sight((solid, light), &next, reach, &mut left);
        if step == Step::Out {
            let other = light
                .sky
                .as_ref()
                .map_or(0.0, |sky| sky.sky_density(next.axis));
            let share = density / (density + other).max(1e-20);
            sum += through * (share * light.sky_light(next.axis));
        }
        decided &= matches!(step, Step::Hit | Step::Out);
        if step != Step::Hit || bounce == look.bounces {
            break;
        }
        (at, point, axis) = (solid.surface(&next, &hit), next.at(hit.t), next.axis);
    }
    (sum, decided)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::pass::shafts::SHAFTS_PURPOSE;
    use crate::plan::lamps::MOST_LAMPS;

    #[test]
    fn no_two_choices_on_a_path_have_the_same_random_numbers() {
        let bounces = 0..=16;
        let lights = 0..=MOST_LAMPS as u32;
        let lit = bounces
            .clone()
            .flat_map(|b| lights.clone().map(move |n| aim_purpose(b, n)));
        let all: Vec<u32> = bounces
            .clone()
            .flat_map(|b| [4 * b + 2, 4 * b + 3, PATH_SKY + 2 * b, PATH_SKY + 2 * b + 1])
            .chain([SHAFTS_PURPOSE, SHAFTS_PURPOSE + 1])
            .chain(lit)
            .collect();
        let different: BTreeSet<u32> = all.iter().copied().collect();
        assert_eq!(different.len(), all.len());
    }
}
