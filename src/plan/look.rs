//! How a picture looks: the section `[look]` of a preset.

use glam::DVec3;

use crate::base::key::{Fault, auto_count, number, switch, triple, triples};
use crate::scene::MOST_SHADOW_STEPS;
use crate::settings;

/// Steps of a shadow ray where the scene does not say how many a ray can need. Only rays that
/// pass close over long slopes of a fractal need more.
pub const SHADOW_STEPS: u32 = 96;
/// The largest number of colours in a palette.
pub const MOST_STOPS: usize = 8;

settings! {
    /// How a picture looks. Colours are sRGB triples from 0 to 1.
    pub struct Look {
        light: DVec3 = DVec3::new(-0.3, -0.7, 0.75), triple(-1e6, 1e6), "direction to the light";
        light_color: DVec3 = DVec3::new(1.0, 0.90, 0.76), triple(0.0, 1.0), "its colour, sRGB";
        key: f64 = 1.7, number(0.0, 100.0), "its strength";
        fill: f64 = 1.6, number(0.0, 100.0), "strength of the sky's light";
        shadow: bool = true, switch(), "whether the light casts shadows";
        light_size: f64 = 2.0, number(0.05, 45.0), "angular radius of the light, degrees";
        shadow_steps: Option<u32> = None, auto_count(1, MOST_SHADOW_STEPS),
            "step limit of a shadow ray; auto is 96 for a formula, and over a heightfield as many as a ray can need, from 96 to 2048; a formula allows at most 512";
        occlusion: f64 = 1.0, number(0.0, 2.0), "strength of ambient occlusion, 0 for none";
        occlusion_reach: f64 = 0.05, number(1e-4, 1.0),
            "how far occlusion looks, as a share of the distance from eye to target";
        fog: f64 = 0.0, number(0.0, 20.0),
            "extinction over the distance from eye to target, 0 for none";
        gloss: f64 = 0.08, number(0.0, 10.0), "specular share";
        sky_high: DVec3 = DVec3::new(0.30, 0.42, 0.58), triple(0.0, 1.0), "sky overhead, sRGB";
        sky_low: DVec3 = DVec3::new(0.80, 0.77, 0.73), triple(0.0, 1.0), "sky below, sRGB";
        palette: Vec<DVec3> = vec![
            DVec3::new(0.16, 0.20, 0.27),
            DVec3::new(0.36, 0.20, 0.17),
            DVec3::new(0.72, 0.42, 0.26),
            DVec3::new(0.86, 0.74, 0.57),
            DVec3::new(0.44, 0.55, 0.54),
        ], triples(MOST_STOPS, 0.0, 1.0), "colours of the surface, sRGB; the orbit trap of a formula or the height picks one";
        palette_cycles: f64 = 1.7, number(0.01, 100.0), "how often the palette repeats";
        exposure: f64 = 0.0, number(-20.0, 20.0), "brightness in stops";
        flag_unconverged: bool = false, switch(),
            "paint pixels that reached a limit in magenta; true for heightfields";
    }
}

impl Look {
    /// Checks that the light has a direction, and that the scene allows so many shadow steps.
    pub fn check(&self, most_shadow_steps: u32) -> Result<(), Fault> {
        Fault::unless(
            self.shadow_steps.is_none_or(|n| n <= most_shadow_steps),
            "look.shadow_steps",
            format!(
                "a shadow ray in this scene may take at most {most_shadow_steps} steps; use \"auto\""
            ),
        )?;
        Fault::unless(
            self.light.length() >= 1e-9,
            "look.light",
            "the direction to the light must not be zero; try [1, -1, 2]",
        )
    }
}
