//! Light, palette and the filmic curve: the part of a look that needs no geometry.
//!
//! Light is linear. A white wall that faces a key light of strength 1 has radiance 1. Tone
//! map and sRGB come last: see `tone.rs` and `tone_map.rs`. Twin: `wgsl/pass/look.wgsl`.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3, Vec4};

use crate::base::oklab::{oklab, unoklab};
use crate::base::srgb::linear;
use crate::pass::LookFeature;
use crate::pass::glow::{Glow, GlowUniform};
use crate::pass::lamp::{Lamp, LampSource, LampUniform};
use crate::pass::material::{MaterialUniform, Substance};
use crate::pass::shafts::{SHAFTS_STEPS, ShaftsUniform, shafts_light};
use crate::pass::sky::{SkyLight, SkyUniform};
use crate::plan::Plan;
use crate::plan::lamps::MOST_LAMPS;
use crate::plan::look::{LightMode, Look, MOST_STOPS, PATH_STEPS, PaletteSpace, SHADOW_STEPS};
use crate::plan::march::Mode;
use crate::scene::sky::Sky;
use crate::scene::{AnySolid, MOST_SHADOW_STEPS};

/// The most rounds of inner loops on a path of light. Mesa's software Vulkan silently ends all loops
/// after 65 535 rounds, and counts those of eight paths together. Usual paths have a tenth of this.
const PATH_ROUNDS: u32 = 30_000;

/// The look as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LookUniform {
    /// Unit vector to the light.
    pub light: Vec3,
    /// Strength of the light.
    pub key: f32,
    /// Colour of the light.
    pub light_color: Vec3,
    /// Strength of the sky.
    pub fill: f32,
    /// Sky overhead.
    pub sky_high: Vec3,
    /// Extinction per unit of length.
    pub fog: f32,
    /// Sky below.
    pub sky_low: Vec3,
    /// 1 if rays to lights go to points of their discs, 0 if they go to the middle.
    pub discs: u32,
    /// Unit vector up.
    pub world_up: Vec3,
    /// Tangent of the light's angular radius.
    pub softness: f32,
    /// Length over which occlusion looks for neighbours.
    pub occlusion_reach: f32,
    /// Strength of occlusion.
    pub occlusion_strength: f32,
    /// Step limit of a shadow ray.
    pub shadow_steps: u32,
    /// Number of colours in the palette.
    pub stops: u32,
    /// How often the palette repeats.
    pub palette_cycles: f32,
    /// 1 to paint unconverged pixels in magenta.
    pub flag: u32,
    /// The share of the lower sky's light that the ground sends back to surfaces.
    pub ground: f32,
    /// How often light goes from surface to surface before the last one, if it is followed.
    pub bounces: u32,
    /// Number of lamps.
    pub lamps: u32,
    /// How near the trap the glow ends.
    pub emission_width: f32,
    /// Unused.
    pub unused: [u32; 2],
    /// Colour times strength of the glow.
    pub emission: Vec3,
    /// The trap that glows, from 0 to 2.
    pub emission_trap: u32,
    /// Scale heights of the fog per unit of length; 0 for fog of one density.
    pub fog_rise: f32,
    /// How many of them the eye is above the fog's level.
    pub fog_start: f32,
    /// The most steps of a path of light.
    pub path_steps: u32,
    /// 1 if colours of palettes are in Oklab.
    pub oklab: u32,
    /// The palette's colours, linear or in Oklab.
    pub palette: [Vec4; MOST_STOPS],
}

/// The parameters of the colour pass as WGSL reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LookParameters {
    /// The look.
    pub look: LookUniform,
    /// What surfaces are made of.
    pub material: MaterialUniform,
    /// The lamps, and zeros after the last one.
    pub lamps: [LampUniform; MOST_LAMPS],
    /// The glow; dark where there is none.
    pub glow: GlowUniform,
    /// Light of the sun in the fog; dark where none is followed.
    pub shafts: ShaftsUniform,
    /// The sky of a file; zeros without one.
    pub sky: SkyUniform,
}

/// A [`Look`] in the numbers that passes use.
#[derive(Clone, Debug)]
pub struct Light {
    /// The look with linear colours, a light direction of length 1, and lengths in the world:
    /// `occlusion_reach` is one, and `fog` is per unit of length.
    pub look: Look,
    /// Tangent of the light's angular radius.
    pub softness: f64,
    /// Whether rays to lights go to points of their discs. A single sample of quick light has no mean, so
    /// its rays go to the middle.
    pub discs: bool,
    /// Step limit of a shadow ray.
    pub shadow_steps: u32,
    /// The most steps of a path of light.
    pub path_steps: u32,
    /// Step limit of a ray from the fog to the sun.
    pub shafts_steps: u32,
    /// Unit vector up.
    pub world_up: DVec3,
    /// The lamps that shine, at most [`MOST_LAMPS`].
    pub lamps: Vec<LampSource>,
    /// What surfaces are made of.
    pub substance: Substance,
    /// Scale heights of the fog per unit of length; 0 for fog of one density.
    pub fog_rise: f64,
    /// How many of them the eye is above the fog's level.
    pub fog_start: f64,
    /// Light of the air near the surface.
    pub glow: Glow,
    /// The sky of a file.
    pub sky: Option<SkyLight>,
}

impl Light {
    /// The light of a plan over its scene.
    pub fn of(plan: &Plan, solid: &AnySolid) -> Self {
        let mut look = plan.look.clone();
        let colors = [
            &mut look.light_color,
            &mut look.emission_color,
            &mut look.sky_high,
            &mut look.sky_low,
        ];
        for color in colors.into_iter() {
            *color = linear(*color);
        }
        let over = [
            &mut look.layers.layer2_palette,
            &mut look.layers.layer3_palette,
        ];
        for palette in std::iter::once(&mut look.palette).chain(over) {
            let stops = palette.len().clamp(1, MOST_STOPS);
            palette.resize(stops, DVec3::ZERO);
            for color in palette {
                *color = match look.palette_space {
                    PaletteSpace::Linear => linear(*color),
                    PaletteSpace::Oklab => oklab(linear(*color)),
                };
            }
        }
        let distance = (plan.camera.target - plan.camera.eye).length();
        look.light = look.light.normalize();
        look.occlusion_reach *= distance;
        look.fog /= distance;
        let least = match look.mode {
            LightMode::Quick => SHADOW_STEPS,
            LightMode::Path => PATH_STEPS,
        };
        let crossing = solid.twin().most_steps().unwrap_or(least);
        let auto = crossing.clamp(least, MOST_SHADOW_STEPS);
        let shadow_steps = look.shadow_steps.unwrap_or(auto);
        // The truth has short steps, and its shadows are as whole as those of other modes.
        let steps = |most: u32| match plan.march.mode {
            Mode::Truth => (f64::from(most) / plan.march.stride()).min(1e6) as u32,
            _ => most,
        };
        // Over a heightfield the rays' own limits are enough: few steps have many rounds.
        let path_steps = match solid.twin().most_steps() {
            Some(most) => 64 * most,
            None => PATH_ROUNDS / (solid.twin().rounds() + 1),
        };
        let shafts_steps = match look.mode {
            LightMode::Quick => steps(shadow_steps.min(path_steps / SHAFTS_STEPS)),
            // A path has its limit in all modes, and so has its ray from the fog.
            LightMode::Path => steps(shadow_steps).min(path_steps / SHAFTS_STEPS),
        };
        let world_up = plan.camera.up.normalize();
        let above =
            (plan.camera.eye - plan.camera.target).dot(world_up) - look.fog_level * distance;
        let fog_rise = match LookFeature::FogHeight.is_on(&look) {
            true => 1.0 / (look.fog_height.max(1e-6) * distance),
            false => 0.0,
        };
        Self {
            softness: look.light_size.to_radians().tan(),
            discs: match look.mode {
                LightMode::Quick => {
                    let rays = [LookFeature::Shadow, LookFeature::Shafts];
                    plan.samples > 1 && rays.iter().any(|feature| feature.is_on(&look))
                }
                LightMode::Path => true,
            },
            shadow_steps: steps(shadow_steps),
            path_steps,
            shafts_steps,
            world_up,
            lamps: LampSource::all(plan),
            substance: Substance::of(&look),
            fog_rise,
            fog_start: fog_rise * above,
            glow: Glow::of(plan, PATH_ROUNDS / (solid.twin().rounds() + 1)),
            sky: None,
            look,
        }
    }

    /// The light under the sky of a file.
    #[must_use]
    pub fn with_sky(self, sky: Option<Arc<Sky>>) -> Self {
        let sky = sky.map(|sky| SkyLight::of(sky, &self.look.sky, self.world_up));
        Self { sky, ..self }
    }

    /// The sun over a scene in which nothing is farther than `far` from the eye.
    pub fn sun(&self, far: f64) -> Lamp {
        Lamp {
            axis: self.look.light,
            far: 2.0 * far,
            softness: self.softness,
        }
    }

    /// Whether the look has a feature.
    pub fn has(&self, feature: LookFeature) -> bool {
        feature.is_on(&self.look)
    }

    fn uniform(&self) -> LookUniform {
        let look = &self.look;
        LookUniform {
            light: look.light.as_vec3(),
            key: look.key as f32,
            light_color: look.light_color.as_vec3(),
            fill: look.fill as f32,
            sky_high: look.sky_high.as_vec3(),
            fog: look.fog as f32,
            sky_low: look.sky_low.as_vec3(),
            discs: u32::from(self.discs),
            world_up: self.world_up.as_vec3(),
            softness: self.softness as f32,
            occlusion_reach: look.occlusion_reach as f32,
            occlusion_strength: look.occlusion as f32,
            shadow_steps: self.shadow_steps,
            stops: look.palette.len() as u32,
            palette_cycles: look.palette_cycles as f32,
            flag: u32::from(look.flag_unconverged),
            ground: look.ground as f32,
            bounces: look.bounces,
            lamps: self.lamps.len() as u32,
            emission_width: look.emission_width as f32,
            unused: [0; 2],
            emission: (look.emission * look.emission_color).as_vec3(),
            emission_trap: look.emission_trap as u32,
            fog_rise: self.fog_rise as f32,
            fog_start: self.fog_start as f32,
            path_steps: self.path_steps,
            oklab: u32::from(look.palette_space == PaletteSpace::Oklab),
            palette: colors(&look.palette),
        }
    }

    /// The values of the WGSL parameters.
    pub fn parameters(&self) -> LookParameters {
        let mut lamps = [LampUniform::zeroed(); MOST_LAMPS];
        for (to, lamp) in lamps.iter_mut().zip(&self.lamps) {
            *to = lamp.uniform();
        }
        LookParameters {
            look: self.uniform(),
            material: self.substance.uniform(),
            lamps,
            glow: self.glow.uniform(),
            shafts: ShaftsUniform {
                light: shafts_light(&self.look).as_vec3(),
                steps: self.shafts_steps,
            },
            sky: self
                .sky
                .as_ref()
                .map_or(Zeroable::zeroed(), SkyLight::uniform),
        }
    }

    /// The palette at x: a triangle wave over evenly spaced colours.
    pub fn palette_at(&self, x: f64) -> DVec3 {
        self.color_at(&self.look.palette, phase(x * self.look.palette_cycles))
    }

    /// The linear colour at a place from 0 to 1 of evenly spaced colours.
    pub fn color_at(&self, palette: &[DVec3], phase: f64) -> DVec3 {
        let last = palette.len() - 1;
        let at = phase * last as f64;
        let i = (at as usize).min(last);
        let f = at - i as f64;
        let j = (i + 1).min(last);
        let mixed = palette[i].lerp(palette[j], f * f * (3.0 - 2.0 * f));
        match self.look.palette_space {
            PaletteSpace::Linear => mixed,
            PaletteSpace::Oklab => unoklab(mixed),
        }
    }

    /// Albedo of a pigment.
    pub fn pigment_color(&self, pigment: DVec3) -> DVec3 {
        self.palette_at(pigment.x) * (0.55 + 0.45 * pigment.y) * (0.85 + 0.3 * pigment.z)
    }
}

/// A triangle wave from 0 at 0 to 1 at 1, which repeats without a seam.
pub fn phase(turns: f64) -> f64 {
    (turns - 2.0 * (0.5 * turns).round()).abs().clamp(0.0, 1.0)
}

/// Colours as WGSL reads them.
pub fn colors(palette: &[DVec3]) -> [Vec4; MOST_STOPS] {
    let mut all = [Vec4::W; MOST_STOPS];
    for (to, from) in all.iter_mut().zip(palette) {
        *to = from.as_vec3().extend(1.0);
    }
    all
}

/// Radiance as a screen shows it, from 0 to 1 and still linear: a factor of exposure, then a
/// rational fit of the ACES curve (Narkowicz 2015).
///
/// ```
/// # use conemarch::pass::look::tone;
/// # use glam::DVec3;
/// assert_eq!(tone(1.0, DVec3::ZERO), DVec3::ZERO);
/// assert_eq!(tone(1.0, DVec3::splat(1e9)), DVec3::ONE);
/// ```
pub fn tone(exposure: f64, c: DVec3) -> DVec3 {
    // Brighter light is white, and its square would overflow.
    let x = (c.max(DVec3::ZERO) * exposure).min(DVec3::splat(1e6));
    let one = x * (x * 2.51 + 0.03) / (x * (x * 2.43 + 0.59) + 0.14);
    one.clamp(DVec3::ZERO, DVec3::ONE)
}

/// The inverse of [`tone`] in one channel, under an exposure of 1, for values from 0 to 1.
pub fn untone(shown: f64) -> f64 {
    let (a, b) = (2.51 - 2.43 * shown, 0.03 - 0.59 * shown);
    ((b * b + 0.56 * a * shown).sqrt() - b) / (2.0 * a)
}

/// Hermite interpolation between two edges, as in WGSL.
pub fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A point of a surface that is lit.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The point.
    pub q: DVec3,
    /// Its normal.
    pub normal: DVec3,
    /// Half a pixel's width there.
    pub grain: f64,
}
