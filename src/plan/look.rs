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
        light_color: DVec3 = DVec3::new(1.0, 0.90, 0.76), triple(0.0, 1.0), "colour of the light, sRGB";
        key: f64 = 1.7, number(0.0, 100.0), "strength of the light";
        fill: f64 = 1.6, number(0.0, 100.0), "strength of the light from the sky";
        shadow: bool = true, switch(), "whether the light casts shadows" => Program;
        light_size: f64 = 2.0, number(0.05, 45.0), "angular radius of the light in degrees; a larger one makes softer shadows";
        shadow_steps: Option<u32> = None, auto_count(1, MOST_SHADOW_STEPS),
            "step limit of a shadow ray, which goes from a hit to the light; auto is 96 for a formula, and over a heightfield as many as a ray can need, from 96 to 2048; a formula allows at most 512";
        occlusion: f64 = 1.0, number(0.0, 2.0), "strength of ambient occlusion, which darkens hollows; 0 for none" => Program;
        occlusion_reach: f64 = 0.05, number(1e-4, 1.0),
            "how far ambient occlusion looks for neighbours, as a share of the distance from eye to target";
        fog: f64 = 0.0, number(0.0, 20.0),
            "density of the fog: at the distance from eye to target, the share exp(-fog) of a colour is left; 0 for none" => Program;
        fog_height: f64 = 0.0, number(0.0, 1000.0),
            "height over which the fog thins out to the share 1/e, as a share of the distance from eye to target; 0 for fog that is as dense everywhere" => Program;
        fog_level: f64 = 0.0, number(-1000.0, 1000.0),
            "height above the target at which the fog has its density, as a share of the distance from eye to target; only for fog_height";
        gloss: f64 = 0.08, number(0.0, 10.0), "strength of the highlights, 0 for none";
        sky_high: DVec3 = DVec3::new(0.30, 0.42, 0.58), triple(0.0, 1.0), "colour of the sky overhead, sRGB";
        sky_low: DVec3 = DVec3::new(0.80, 0.77, 0.73), triple(0.0, 1.0), "colour of the sky below, sRGB";
        palette: Vec<DVec3> = vec![
            DVec3::new(0.16, 0.20, 0.27),
            DVec3::new(0.36, 0.20, 0.17),
            DVec3::new(0.72, 0.42, 0.26),
            DVec3::new(0.86, 0.74, 0.57),
            DVec3::new(0.44, 0.55, 0.54),
        ], triples(MOST_STOPS, 0.0, 1.0), "colours of the surface, sRGB; the height picks one, or the orbit trap of a formula: how near the iterated point comes to given shapes";
        palette_cycles: f64 = 1.7, number(0.01, 100.0), "how many times the palette is passed through, in turns forwards and backwards";
        exposure: f64 = 0.0, number(-20.0, 20.0), "brightness in stops; each stop doubles the light" => Tone;
        flag_unconverged: bool = false, switch(),
            "whether pixels are magenta if their ray or their shadow ray reached its step limit; the default is true for heightfields";
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
