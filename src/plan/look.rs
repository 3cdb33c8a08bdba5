//! How a picture looks: the section `[look]` of a preset.

use glam::DVec3;

use super::lamps::Lamps;
use super::layers::Layers;
use super::sky::SkySettings;
use crate::base::key::{
    Fault, auto_count, auto_number, auto_triple, count, number, switch, triple, triples, word,
};
use crate::base::named::named_enum;
use crate::scene::MOST_SHADOW_STEPS;
use crate::settings;

/// Steps of a shadow ray where the scene does not say how many a ray can need. Only rays that
/// pass close over long slopes of a fractal need more.
pub const SHADOW_STEPS: u32 = 96;
/// The same in mode path, whose rays go on where others end dark. They rarely need more than 200.
pub const PATH_STEPS: u32 = 512;
/// The largest number of colours in a palette.
pub const MOST_STOPS: usize = 16;

named_enum! {
    /// How light is found.
    #[derive(Default)]
    pub enum LightMode {
        /// By formulas.
        #[default]
        Quick = "quick",
        /// By rays from surface to surface.
        Path = "path",
    }
}

named_enum! {
    /// An orbit trap: what the iterated point comes near to.
    #[derive(Default)]
    pub enum EmissionTrap {
        /// The origin.
        Origin = "origin",
        /// The coordinate planes.
        #[default]
        Plane = "plane",
        /// The sphere that ball folds keep.
        Sphere = "sphere",
    }
}

/// The temperature of daylight (D65) in kelvins, which leaves colours as they are.
pub const DAYLIGHT: f64 = 6504.0;

named_enum! {
    /// How light becomes display values: `crate::pass::tone_map`.
    pub enum ToneMap {
        /// A rational curve of each channel (Narkowicz 2015).
        Filmic = "filmic",
        /// AgX.
        Agx = "agx",
        /// AgX with more contrast and colour.
        Punchy = "agx-punchy",
        /// The neutral map of the Khronos group.
        Neutral = "neutral",
        /// A fit of ACES by Stephen Hill.
        Aces = "aces",
        /// None: what is brighter than white is clipped.
        None = "none",
    }
}

named_enum! {
    /// Where the colours of palettes blend.
    pub enum PaletteSpace {
        /// Linear light.
        Linear = "linear",
        /// Oklab.
        Oklab = "oklab",
    }
}

settings! {
    /// How a picture looks. Colours are sRGB triples from 0 to 1.
    pub struct Look {
        light: DVec3 = DVec3::new(-0.3, -0.7, 0.75), triple(-1e6, 1e6), "direction to the light; must not be [0, 0, 0]";
        light_color: DVec3 = DVec3::new(1.0, 0.90, 0.76), triple(0.0, 1.0), "colour of the light, sRGB";
        mode: LightMode = LightMode::Quick, word(&LightMode::WORDS), "how light is found: quick by formulas, and with several samples by rays to points of each light; path by rays from surface to surface. The noise of rays goes away with many samples" => Program;
        bounces: u32 = 2, count(0, 16), "in mode path, how many surfaces light may come from before it reaches the one that is seen; 0 for light of the sun, lamps and the sky alone, and then only surfaces within occlusion_reach hide the sky. In the fine folds of a fractal, white surfaces lose a sixth to a third of their light even at 16";
        roughness: f64 = 0.45, number(0.05, 1.0), "roughness of the surface: 0.05 is a polished one, 1 a dull one";
        metal: f64 = 0.0, number(0.0, 1.0), "1 for metal, whose reflections have the colour of the surface, and 0 for paint";
        key: f64 = 1.7, number(0.0, 100.0), "strength of the light";
        fill: f64 = 1.6, number(0.0, 100.0), "strength of the light from the sky";
        lamp: f64 = 0.0, number(0.0, 1e6), "strength of a lamp in the scene, 0 for none: a white wall that faces it at the distance from eye to target has this radiance, and at a tenth of it a hundred times more" => Program;
        lamp_at: Option<DVec3> = None, auto_triple(-1e9, 1e9), "position of the lamp; auto is the eye";
        lamp_color: DVec3 = DVec3::new(1.0, 0.72, 0.42), triple(0.0, 1.0), "colour of the lamp, sRGB";
        lamp_size: f64 = 0.005, number(1e-4, 1.0), "radius of the lamp as a share of the distance from eye to target; a larger one makes softer shadows, if there are several samples";
        lamp_cone: Option<f64> = None, auto_number(1.0, 360.0), "full angle in degrees of the cone in which the lamp shines, with a soft edge within; auto or 360 is everywhere";
        lamp_toward: Option<DVec3> = None, auto_triple(-1e9, 1e9), "the point in the middle of the cone; auto is the target; a lamp at that point shines down";
        emission: f64 = 0.0, number(0.0, 1e4), "light that the surface itself sends out where its trap is near, 0 for none" => Program;
        emission_trap: EmissionTrap = EmissionTrap::Plane, word(&EmissionTrap::WORDS), "the orbit trap of a formula that glows; over a heightfield, origin is the lowest ground";
        emission_width: f64 = 0.1, number(0.001, 1.0), "how near the trap the glow ends";
        emission_color: DVec3 = DVec3::new(1.0, 0.35, 0.08), triple(0.0, 1.0), "colour of the glow, sRGB";
        ground: f64 = 0.45, number(0.0, 1.0), "share of the light of the lower sky that reaches surfaces: the ground absorbs the rest";
        shadow: bool = true, switch(), "in mode quick, whether the light casts shadows" => Program;
        light_size: f64 = 2.0, number(0.05, 45.0), "angular radius of the light in degrees; a larger one makes softer shadows, if there are several samples";
        shadow_steps: Option<u32> = None, auto_count(1, MOST_SHADOW_STEPS),
            "step limit of a ray from a hit or from the fog to the light, in mode path also of one to another surface; a formula allows at most 512. With auto, a formula has 96, or 512 in mode path, and a heightfield as many as a ray can need, up to 2048";
        occlusion: f64 = 1.0, number(0.0, 2.0), "in mode quick, strength of ambient occlusion, which darkens hollows; 0 for none" => Program;
        occlusion_reach: f64 = 0.05, number(1e-4, 1.0),
            "how far ambient occlusion looks for neighbours, as a share of the distance from eye to target";
        fog: f64 = 0.0, number(0.0, 20.0),
            "density of the fog: at the distance from eye to target, the share exp(-fog) of a colour is left; 0 for none" => Program;
        fog_height: f64 = 0.0, number(0.0, 1000.0),
            "height over which the fog thins out to 1/e, as a share of the distance from eye to target; 0 for fog that is as dense everywhere" => Program;
        fog_level: f64 = 0.0, number(-1000.0, 1000.0),
            "height above the target at which the fog has its density, as a share of the distance from eye to target; only for fog_height";
        shafts: f64 = 0.0, number(0.0, 20.0),
            "with fog, the share of the light's rays that fog scatters, so that shafts of light are seen between shadows; 1 is fog that absorbs nothing, 0 is fog that shows the sky's colour alone" => Program;
        glow: f64 = 0.0, number(0.0, 100.0),
            "strength of light that the air of a formula sends out near the surface, 0 for none: a ray that meets a flat wall gains this much radiance, and one that passes close by more; a transparent background has it only before hits" => Program;
        glow_width: f64 = 0.02, number(0.005, 1.0),
            "distance from the surface at which the glow of the air has fallen to 1/e, as a share of the distance from eye to target";
        glow_color: DVec3 = DVec3::new(0.30, 0.55, 1.0), triple(0.0, 1.0), "colour of the glow of the air, sRGB";
        gloss: f64 = 0.08, number(0.0, 10.0), "strength of the highlights of paint: 0 for none, 0.08 for most materials, 2 and more for a mirror; a metal has its own";
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
        palette_space: PaletteSpace = PaletteSpace::Oklab, word(&PaletteSpace::WORDS), "in which space the colours of palettes blend: as light, or in Oklab, where equal steps look equally large and blends keep their colour";
        tone: ToneMap = ToneMap::Filmic, word(&ToneMap::WORDS), "how light becomes display values: a filmic curve of each channel, AgX, AgX with more contrast, the neutral map that keeps palettes true, a fit of ACES, or none, which clips" => Tone;
        white: f64 = DAYLIGHT, number(1500.0, 15000.0), "temperature in kelvins of the light that appears white; a lower one makes the picture bluer" => Tone;
        saturation: f64 = 1.0, number(0.0, 4.0), "strength of the colours before the tone map, 0 for grey" => Tone;
        bloom: f64 = 0.0, number(0.0, 1.0), "share of the light that the lens spreads over the picture, so that bright places shine; 0 for none, 0.04 is a good lens, 0.2 a misty one; an EXR has none" => Tone;
        flag_unconverged: bool = false, switch(),
            "whether pixels are magenta if their ray reached its step limit, and in mode quick those of surfaces also if their shadow ray or their ray from the fog to the sun did; the default is true for heightfields";
        /// A sky in a file.
        ..sky: SkySettings;
        /// Traps and layers.
        ..layers: Layers;
        /// Further lamps.
        ..lamps: Lamps;
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
