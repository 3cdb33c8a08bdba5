//! Light, palette and tone: a picture's look, without geometry.
//!
//! Light is linear, in units in which a white wall under the key light at strength 1
//! has radiance 1. Twin: `wgsl/pass/look.wgsl`; tone and sRGB are applied only where
//! pictures are written, so they have none.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3, Vec4};

use crate::base::shader::Module;
use crate::base::srgb::linear;
use crate::pass::LookFeature;
use crate::plan::Plan;
use crate::plan::look::{Look, MOST_STOPS, SHADOW_STEPS};
use crate::scene::{Assets, MOST_SHADOW_STEPS};
use crate::wgsl;

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
    /// Paint unconverged pixels.
    pub flag: bool,
    on: Vec<LookFeature>,
}

impl Light {
    /// The look made ready: linear colours, lengths in the world. `up` is the world's,
    /// `distance` that from the eye to the target, `crossing` the most steps that a ray can
    /// take through the scene, where that is known.
    pub fn new(look: &Look, up: DVec3, distance: f64, crossing: Option<u32>) -> Self {
        let mut palette = [DVec3::ZERO; MOST_STOPS];
        for (to, from) in palette.iter_mut().zip(&look.palette) {
            *to = linear(*from);
        }
        Self {
            light: look.light.normalize(),
            light_color: linear(look.light_color),
            key: look.key,
            fill: look.fill,
            softness: look.light_size.to_radians().tan(),
            shadow_steps: look.shadow_steps.unwrap_or_else(|| {
                let enough = crossing.unwrap_or(SHADOW_STEPS);
                enough.clamp(SHADOW_STEPS, MOST_SHADOW_STEPS)
            }),
            occlusion_strength: look.occlusion,
            occlusion_reach: look.occlusion_reach * distance,
            fog: look.fog / distance,
            gloss: look.gloss,
            sky_high: linear(look.sky_high),
            sky_low: linear(look.sky_low),
            world_up: up.normalize(),
            palette,
            stops: look.palette.len().clamp(1, MOST_STOPS),
            palette_cycles: look.palette_cycles,
            flag: look.flag_unconverged,
            on: LookFeature::ALL
                .iter()
                .copied()
                .filter(|f| f.is_on(look))
                .collect(),
        }
    }

    /// The light of a plan.
    pub fn of(plan: &Plan, assets: &Assets) -> Self {
        let camera = &plan.camera;
        let distance = (camera.target - camera.eye).length();
        let up = camera.up.try_normalize().unwrap_or(DVec3::Z);
        Self::new(&plan.look, up, distance, plan.scene.most_steps(assets))
    }

    /// Whether the look has a feature.
    pub fn has(&self, feature: LookFeature) -> bool {
        self.on.contains(&feature)
    }

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
}

/// Radiance as it is shown, 0..1, still linear: a factor of exposure, then a rational fit of
/// the ACES curve (Narkowicz 2015).
pub fn tone(exposure: f64, c: DVec3) -> DVec3 {
    let x = c.max(DVec3::ZERO) * exposure;
    let one = x * (x * 2.51 + 0.03) / (x * (x * 2.43 + 0.59) + 0.14);
    one.clamp(DVec3::ZERO, DVec3::ONE)
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
        assert_eq!(tone(1.0, DVec3::ZERO), DVec3::ZERO);
        assert_eq!(tone(1.0, DVec3::splat(1e9)), DVec3::ONE);
    }
}
