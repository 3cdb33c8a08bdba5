//! Light, palette and tone: a picture's look, without geometry.
//!
//! Light is linear, in units in which a white wall under the key light at strength 1
//! has radiance 1. Twin: `wgsl/pass/look.wgsl`; tone and sRGB are applied only where
//! pictures are written, so they have none.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3, Vec4};

use crate::key::{AutoCount, Fault, Key, List, Number, Switch, Triple};
use crate::shader::Module;
use crate::srgb::linear;
use crate::wgsl;

/// Steps that are enough for the rays of shadows among fractals, but for those that pass
/// close over long slopes.
const SHADOW_STEPS: u32 = 96;
/// Most over heightfields. With the rounds of the loops in them they stay under the 65 535
/// after which Mesa's software Vulkan ends loops.
const MOST_SHADOW_STEPS: u32 = 2048;
/// Most where each step has the iterations of a formula in it.
pub const MOST_SHADOW_STEPS_OF_FORMULAS: u32 = 512;

/// Most colours in a palette.
pub const MOST_STOPS: usize = 8;

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
    /// Specular share.
    pub gloss: f32,
    /// Unit vector up.
    pub world_up: Vec3,
    /// Tangent of the light's angular radius.
    pub softness: f32,
    /// Length over which occlusion looks for neighbours.
    pub occlusion_reach: f32,
    /// Strength of occlusion.
    pub occlusion_strength: f32,
    /// Steps of a shadow ray.
    pub shadow_steps: u32,
    /// Colours in the palette.
    pub stops: u32,
    /// How often the palette is run through.
    pub palette_cycles: f32,
    /// 1 to paint unconverged pixels in magenta.
    pub flag: u32,
    /// Unused.
    pub pad: [u32; 2],
    /// The palette's colours, linear.
    pub palette: [Vec4; MOST_STOPS],
}

/// The WGSL module of the look.
pub fn module() -> Module {
    wgsl!("pass/look.wgsl")
}

/// How a picture looks. Colours are sRGB triples in 0..1, as a colour picker gives
/// them.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Direction to the light.
    pub light: DVec3,
    /// Its colour.
    pub light_color: DVec3,
    /// Its strength.
    pub key: f64,
    /// Strength of sky and bounce light.
    pub fill: f64,
    /// Whether the key light casts shadows.
    pub shadow: bool,
    /// Angular radius of the light in degrees.
    pub light_size: f64,
    /// Steps that a shadow ray may do; `None` for as many as the scene needs.
    pub shadow_steps: Option<u32>,
    /// Strength of ambient occlusion; 0 is off.
    pub occlusion: f64,
    /// Length over which occlusion looks, as a share of the distance to the target.
    pub occlusion_reach: f64,
    /// Extinction over the distance to the target; 0 is off.
    pub fog: f64,
    /// Specular share.
    pub gloss: f64,
    /// Sky overhead.
    pub sky_high: DVec3,
    /// Sky below.
    pub sky_low: DVec3,
    /// Colours that the orbit's traps are looked up in.
    pub palette: Vec<DVec3>,
    /// How often the palette is run through.
    pub palette_cycles: f64,
    /// Factor on radiance before tone, in powers of two.
    pub exposure: f64,
    /// Paint unconverged pixels in magenta.
    pub flag_unconverged: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            light: DVec3::new(-0.3, -0.7, 0.75),
            light_color: DVec3::new(1.0, 0.90, 0.76),
            key: 1.7,
            fill: 1.6,
            shadow: true,
            light_size: 2.0,
            shadow_steps: None,
            occlusion: 1.0,
            occlusion_reach: 0.05,
            fog: 0.0,
            gloss: 0.08,
            sky_high: DVec3::new(0.30, 0.42, 0.58),
            sky_low: DVec3::new(0.80, 0.77, 0.73),
            palette: vec![
                DVec3::new(0.16, 0.20, 0.27),
                DVec3::new(0.36, 0.20, 0.17),
                DVec3::new(0.72, 0.42, 0.26),
                DVec3::new(0.86, 0.74, 0.57),
                DVec3::new(0.44, 0.55, 0.54),
            ],
            palette_cycles: 1.7,
            exposure: 0.0,
            flag_unconverged: false,
        }
    }
}

impl Look {
    /// The keys of `[look]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        vec![
            Key::new(
                "light",
                Triple(&mut self.light, -1e6, 1e6),
                "direction to the light",
            ),
            Key::new(
                "light_color",
                Triple(&mut self.light_color, 0.0, 1.0),
                "its colour, sRGB",
            ),
            Key::new("key", Number(&mut self.key, 0.0, 100.0), "its strength"),
            Key::new(
                "fill",
                Number(&mut self.fill, 0.0, 100.0),
                "strength of the sky's light",
            ),
            Key::new(
                "shadow",
                Switch(&mut self.shadow),
                "whether the light casts shadows",
            ),
            Key::new(
                "light_size",
                Number(&mut self.light_size, 0.05, 45.0),
                "angular radius of the light, degrees",
            ),
            Key::new(
                "shadow_steps",
                AutoCount(&mut self.shadow_steps, 1, MOST_SHADOW_STEPS),
                "steps that a shadow ray may do; auto is 96, over a heightfield as many more as one can take, up to 2048; at most 512 for a formula",
            ),
            Key::new(
                "occlusion",
                Number(&mut self.occlusion, 0.0, 2.0),
                "strength of ambient occlusion, 0 for none",
            ),
            Key::new(
                "occlusion_reach",
                Number(&mut self.occlusion_reach, 1e-4, 1.0),
                "how far occlusion looks, as a share of the distance from eye to target",
            ),
            Key::new(
                "fog",
                Number(&mut self.fog, 0.0, 20.0),
                "extinction over the distance from eye to target, 0 for none",
            ),
            Key::new(
                "gloss",
                Number(&mut self.gloss, 0.0, 10.0),
                "specular share",
            ),
            Key::new(
                "sky_high",
                Triple(&mut self.sky_high, 0.0, 1.0),
                "sky overhead, sRGB",
            ),
            Key::new(
                "sky_low",
                Triple(&mut self.sky_low, 0.0, 1.0),
                "sky below, sRGB",
            ),
            Key::new(
                "palette",
                List(&mut self.palette, 1..=MOST_STOPS, 0.0, 1.0),
                "colours that the orbit's traps are looked up in, sRGB",
            ),
            Key::new(
                "palette_cycles",
                Number(&mut self.palette_cycles, 0.01, 100.0),
                "how often the palette is run through",
            ),
            Key::new(
                "exposure",
                Number(&mut self.exposure, -20.0, 20.0),
                "brightness in stops",
            ),
            Key::new(
                "flag_unconverged",
                Switch(&mut self.flag_unconverged),
                "paint pixels that reached a limit in magenta; true for heightfields",
            ),
        ]
    }

    /// Whether the light has a direction.
    pub fn check(&self) -> Result<(), Fault> {
        if self.light.length() < 1e-9 {
            return Err(Fault::new(
                "look.light",
                "the direction to the light must not be zero; [1, -1, 2] would do",
            ));
        }
        Ok(())
    }

    /// The look made ready: linear colours, lengths in the world. `up` is the world's,
    /// `distance` that from the eye to the target, `crossing` the most steps that a ray can
    /// take through the scene, where that is known.
    pub fn light(&self, up: DVec3, distance: f64, crossing: Option<u32>) -> Light {
        let mut palette = [DVec3::ZERO; MOST_STOPS];
        for (to, from) in palette.iter_mut().zip(&self.palette) {
            *to = linear(*from);
        }
        Light {
            light: self.light.normalize(),
            light_color: linear(self.light_color),
            key: self.key,
            fill: self.fill,
            softness: self.light_size.to_radians().tan(),
            shadow_steps: self.shadow_steps.unwrap_or_else(|| {
                let enough = crossing.unwrap_or(SHADOW_STEPS);
                enough.clamp(SHADOW_STEPS, MOST_SHADOW_STEPS)
            }),
            occlusion_strength: self.occlusion,
            occlusion_reach: self.occlusion_reach * distance,
            fog: self.fog / distance,
            gloss: self.gloss,
            sky_high: linear(self.sky_high),
            sky_low: linear(self.sky_low),
            world_up: up.normalize(),
            palette,
            stops: self.palette.len().clamp(1, MOST_STOPS),
            palette_cycles: self.palette_cycles,
            exposure: self.exposure.exp2(),
            flag: self.flag_unconverged,
            shadowed: self.shadow,
        }
    }
}

/// A [`Look`] in linear colours and world lengths.
#[derive(Clone, Debug)]
pub struct Light {
    /// Unit vector to the light.
    pub light: DVec3,
    /// Colour of the light.
    pub light_color: DVec3,
    /// Strength of the light.
    pub key: f64,
    /// Strength of the sky.
    pub fill: f64,
    /// Tangent of the light's angular radius.
    pub softness: f64,
    /// Steps of a shadow ray.
    pub shadow_steps: u32,
    /// Strength of occlusion.
    pub occlusion_strength: f64,
    /// Length over which occlusion looks.
    pub occlusion_reach: f64,
    /// Extinction per unit of length.
    pub fog: f64,
    /// Specular share.
    pub gloss: f64,
    /// Sky overhead.
    pub sky_high: DVec3,
    /// Sky below.
    pub sky_low: DVec3,
    /// Unit vector up.
    pub world_up: DVec3,
    /// Palette, of which `stops` count.
    pub palette: [DVec3; MOST_STOPS],
    /// Colours in the palette.
    pub stops: usize,
    /// How often the palette is run through.
    pub palette_cycles: f64,
    /// Factor before tone.
    pub exposure: f64,
    /// Paint unconverged pixels.
    pub flag: bool,
    /// Whether the light casts shadows.
    pub shadowed: bool,
}

impl Light {
    /// The values that WGSL gets.
    #[allow(clippy::cast_possible_truncation, reason = "f32 is what the GPU takes")]
    pub fn uniform(&self) -> LookUniform {
        LookUniform {
            light: self.light.as_vec3(),
            key: self.key as f32,
            light_color: self.light_color.as_vec3(),
            fill: self.fill as f32,
            sky_high: self.sky_high.as_vec3(),
            fog: self.fog as f32,
            sky_low: self.sky_low.as_vec3(),
            gloss: self.gloss as f32,
            world_up: self.world_up.as_vec3(),
            softness: self.softness as f32,
            occlusion_reach: self.occlusion_reach as f32,
            occlusion_strength: self.occlusion_strength as f32,
            shadow_steps: self.shadow_steps,
            stops: self.stops as u32,
            palette_cycles: self.palette_cycles as f32,
            flag: u32::from(self.flag),
            pad: [0; 2],
            palette: self.palette.map(|c| c.as_vec3().extend(1.0)),
        }
    }

    /// Radiance of the sky in a direction.
    pub fn sky(&self, axis: DVec3) -> DVec3 {
        let blend = smoothstep(-0.6, 0.8, axis.dot(self.world_up));
        let near = axis.dot(self.light).max(0.0);
        self.sky_low.lerp(self.sky_high, blend) + self.light_color * (0.12 * near.powi(6))
    }

    /// The palette at x: a triangle wave over evenly spaced stops.
    pub fn palette_at(&self, x: f64) -> DVec3 {
        let last = self.stops - 1;
        let turns = x * self.palette_cycles;
        let phase = (turns - 2.0 * (0.5 * turns).round()).abs().clamp(0.0, 1.0);
        let at = phase * last as f64;
        let i = (at as usize).min(last);
        let f = at - i as f64;
        let j = (i + 1).min(last);
        self.palette[i].lerp(self.palette[j], f * f * (3.0 - 2.0 * f))
    }

    /// Albedo of a pigment.
    pub fn pigment_color(&self, pigment: DVec3) -> DVec3 {
        self.palette_at(pigment.x) * (0.55 + 0.45 * pigment.y) * (0.85 + 0.3 * pigment.z)
    }

    /// Radiance as it is shown, 0..1, still linear: exposure, then a rational fit of
    /// the ACES curve (Narkowicz 2015).
    pub fn tone(&self, c: DVec3) -> DVec3 {
        let x = c.max(DVec3::ZERO) * self.exposure;
        let one = x * (x * 2.51 + 0.03) / (x * (x * 2.43 + 0.59) + 0.14);
        one.clamp(DVec3::ZERO, DVec3::ONE)
    }
}

/// Hermite interpolation between two edges, as WGSL's.
pub fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tone_keeps_black_black_and_never_exceeds_white() {
        let light = Look::default().light(DVec3::Z, 1.0, None);
        assert_eq!(light.tone(DVec3::ZERO), DVec3::ZERO);
        assert_eq!(light.tone(DVec3::splat(1e9)), DVec3::ONE);
    }
}
