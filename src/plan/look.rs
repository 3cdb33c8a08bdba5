//! How a picture looks: the keys of `[look]`.

use glam::DVec3;

use crate::keys;

use crate::base::key::{AutoCount, Fault, Key, List, Number, Switch, Triple};
use crate::scene::MOST_SHADOW_STEPS;

/// Steps that are enough for the rays of shadows among fractals, but for those that pass
/// close over long slopes.
pub const SHADOW_STEPS: u32 = 96;
/// Most colours in a palette.
pub const MOST_STOPS: usize = 8;

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
        keys![
            "light" = Triple(&mut self.light, -1e6, 1e6),
                "direction to the light";
            "light_color" = Triple(&mut self.light_color, 0.0, 1.0),
                "its colour, sRGB";
            "key" = Number(&mut self.key, 0.0, 100.0),
                "its strength";
            "fill" = Number(&mut self.fill, 0.0, 100.0),
                "strength of the sky's light";
            "shadow" = Switch(&mut self.shadow),
                "whether the light casts shadows";
            "light_size" = Number(&mut self.light_size, 0.05, 45.0),
                "angular radius of the light, degrees";
            "shadow_steps" = AutoCount(&mut self.shadow_steps, 1, MOST_SHADOW_STEPS),
                "steps that a shadow ray may do; auto is 96, over a heightfield as many more as one can take, up to 2048; at most 512 for a formula";
            "occlusion" = Number(&mut self.occlusion, 0.0, 2.0),
                "strength of ambient occlusion, 0 for none";
            "occlusion_reach" = Number(&mut self.occlusion_reach, 1e-4, 1.0),
                "how far occlusion looks, as a share of the distance from eye to target";
            "fog" = Number(&mut self.fog, 0.0, 20.0),
                "extinction over the distance from eye to target, 0 for none";
            "gloss" = Number(&mut self.gloss, 0.0, 10.0),
                "specular share";
            "sky_high" = Triple(&mut self.sky_high, 0.0, 1.0),
                "sky overhead, sRGB";
            "sky_low" = Triple(&mut self.sky_low, 0.0, 1.0),
                "sky below, sRGB";
            "palette" = List(&mut self.palette, 1..=MOST_STOPS, 0.0, 1.0),
                "colours that the orbit's traps are looked up in, sRGB";
            "palette_cycles" = Number(&mut self.palette_cycles, 0.01, 100.0),
                "how often the palette is run through";
            "exposure" = Number(&mut self.exposure, -20.0, 20.0),
                "brightness in stops";
            "flag_unconverged" = Switch(&mut self.flag_unconverged),
                "paint pixels that reached a limit in magenta; true for heightfields";
        ]
    }

    /// Checks that the light has a direction, and shadows no more steps than the scene
    /// allows.
    pub fn check(&self, most_shadow_steps: u32) -> Result<(), Fault> {
        if self.shadow_steps.is_some_and(|n| n > most_shadow_steps) {
            return Err(Fault::new(
                "look.shadow_steps",
                format!(
                    "a shadow ray in this scene may take at most {most_shadow_steps} steps; use \"auto\""
                ),
            ));
        }
        if self.light.length() < 1e-9 {
            return Err(Fault::new(
                "look.light",
                "the direction to the light must not be zero; try [1, -1, 2]",
            ));
        }
        Ok(())
    }
}
