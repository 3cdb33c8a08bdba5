//! One layer of a frame as display values: what a picture of it shows.
//!
//! Colour is tone-mapped. [`Layer`] says how each of the other layers becomes a picture.
//! Values are encoded for display, 0..1, so that a file only has to round them.

use glam::DVec3;

use crate::base::named::named_enum;
use crate::base::outcome::State;
use crate::base::parallel::for_each_part;
use crate::pass::tone::{byte, level};
use crate::pass::tone_map::Tone;
use crate::picture::bloom::Bloom;
use crate::picture::frame::{Frame, in_image};
use crate::plan::{Background, Extras, Plan};
use crate::raster::png::{self, BitDepth};

/// What is particular to a layer.
#[derive(Clone, Copy, Debug)]
pub struct LayerFacts {
    /// What it shows.
    pub help: &'static str,
    /// Numbers per pixel, without alpha: one is enough for a depth.
    pub channels: usize,
    /// Whether a part of a picture can be shown without the rest.
    pub is_local: bool,
    /// What a render must keep for it.
    pub extras: Extras,
}

/// Three numbers per pixel that need the whole picture, and no colours.
fn marched(help: &'static str) -> LayerFacts {
    LayerFacts {
        help,
        channels: 3,
        is_local: false,
        extras: Extras {
            depth_only: true,
            ..Extras::default()
        },
    }
}

/// Three numbers per pixel that need only the pixel's light, normal or samples.
fn colored(help: &'static str) -> LayerFacts {
    LayerFacts {
        is_local: true,
        extras: Extras::default(),
        ..marched(help)
    }
}

named_enum! {
    /// What a picture can show.
    #[derive(Default)]
    pub enum Layer: LayerFacts {
        /// Radiance as a screen shows it.
        #[default]
        Color = "color" => colored("light, tone-mapped"),
        /// Distances along the rays.
        Depth = "depth" => LayerFacts {
            channels: 1,
            ..marched("distance from the eye as grey: nearest black, farthest 95 % white, sky white")
        },
        /// Normals in the world.
        Normal = "normal" => LayerFacts {
            extras: Extras { normals: true, ..Extras::default() },
            ..colored("world normals, x y z as red green blue, -1..1 to 0..1; sky mid grey")
        },
        /// Positions in the world.
        Position = "position" =>
            marched("world positions, each axis from its least to its greatest in the picture; sky black"),
        /// The work of each pixel.
        Steps = "steps" => LayerFacts {
            extras: Extras { count: true, depth_only: true, ..Extras::default() },
            ..marched("how often the distance to the surface was computed: violet none, yellow the 99th percentile and above")
        },
        /// What each pixel is.
        State = "state" => LayerFacts {
            is_local: true,
            ..marched("sky dark blue, hit light grey, unconverged (the ray reached its step limit) magenta")
        },
        /// Samples of each pixel.
        Samples = "samples" => LayerFacts {
            channels: 1,
            ..colored("share of image.samples that a pixel has, as grey: black none, white all; image.until stops sampling smooth tiles early")
        },
        /// How much the samples of each pixel differ.
        Variance = "variance" => LayerFacts {
            channels: 1,
            extras: Extras { variance: true, ..Extras::default() },
            ..colored("square root of the variance of a pixel's luminance, computed as if its samples were random: black 0, white 0.1 and more; an EXR has the variance")
        },
        /// Errors of the depth.
        Error = "error" =>
            marched("error of the depth. A slow reference, the truth, is rendered too. Grey is no error. Red is 8 half pixels too deep, or no hit. Blue is 8 half pixels too near"),
    }
}

impl Layer {
    /// Whether files of the layer have alpha: colours over a transparent background.
    pub fn has_alpha(self, plan: &Plan) -> bool {
        self == Self::Color && plan.background == Background::Transparent
    }
}

/// A layer of a frame, ready to be asked for pixels.
pub struct Shades<'a> {
    layer: Layer,
    size: [u32; 2],
    origin: [u32; 2],
    ppi: Option<u32>,
    /// The share of hits in each pixel; empty without alpha.
    alpha: &'a [f32],
    shade: Box<dyn Fn(usize) -> DVec3 + Sync + 'a>,
}

/// Stops of the heat map: viridis at even distances (van der Walt and Smith 2015),
/// sRGB.
const HEAT: [DVec3; 6] = [
    DVec3::new(0.267, 0.005, 0.329),
    DVec3::new(0.254, 0.265, 0.530),
    DVec3::new(0.164, 0.471, 0.558),
    DVec3::new(0.135, 0.659, 0.518),
    DVec3::new(0.478, 0.821, 0.319),
    DVec3::new(0.993, 0.906, 0.144),
];

/// Grey of the farthest depth: sky is brighter.
const FARTHEST: f64 = 0.95;

/// Standard errors from this on are white.
const MOST_ERROR: f64 = 0.1;

/// Errors in footprints above this have the same colour.
const MOST_APART: f64 = 8.0;
const TOO_DEEP: [DVec3; 2] = [DVec3::new(0.90, 0.55, 0.10), DVec3::new(0.55, 0.0, 0.05)];
const TOO_NEAR: [DVec3; 2] = [DVec3::new(0.25, 0.60, 0.90), DVec3::new(0.05, 0.10, 0.50)];

const SKY: DVec3 = DVec3::new(0.09, 0.15, 0.30);
const HIT: DVec3 = DVec3::new(0.82, 0.82, 0.82);
const UNCONVERGED: DVec3 = DVec3::new(1.0, 0.0, 1.0);

impl<'a> Shades<'a> {
    /// A layer of a frame that was rendered with [`LayerFacts::extras`] from a plan. A part of a picture
    /// has no bloom: see [`Shades::of_part`].
    pub fn new(layer: Layer, frame: &'a Frame, plan: &Plan) -> Self {
        let bloom = match layer {
            Layer::Color => Bloom::of(frame, plan),
            _ => None,
        };
        Self::of_part((layer, frame, plan), bloom)
    }

    /// The same of a part of a picture, with the bloom of the whole one, if its look has any.
    pub fn of_part((layer, frame, plan): (Layer, &'a Frame, &Plan), bloom: Option<Bloom>) -> Self {
        let shade: Box<dyn Fn(usize) -> DVec3 + Sync + 'a> = match layer {
            Layer::Color => {
                let tone = Tone::of(&plan.look);
                // The light of the hits is straight: not multiplied by their share.
                let share = |i: usize| frame.alpha.get(i).map_or(1.0, |a| f64::from(*a));
                let least = f64::MIN_POSITIVE;
                let light = move |i| vector(frame.radiance[i]) / share(i).max(least);
                match bloom {
                    None => Box::new(move |i| tone.shown(light(i))),
                    Some(bloom) => {
                        Box::new(move |i| tone.shown(bloom.over(light(i), frame.pixel(i))))
                    }
                }
            }
            Layer::Depth => {
                let depth = |t: &f32| DVec3::splat(f64::from(*t));
                let share = shares(&mut frame.depth.iter().map(depth));
                Box::new(move |i| match frame.depth[i] {
                    t if t.is_finite() => share(depth(&t)) * FARTHEST,
                    _ => DVec3::ONE,
                })
            }
            Layer::Normal => Box::new(|i| vector(frame.normal[i]) * 0.5 + 0.5),
            Layer::Position => {
                let positions = frame.positions(&plan.picture_rays());
                let share = shares(&mut positions.iter().copied().map(vector));
                Box::new(move |i| match vector(positions[i]) {
                    p if p.is_finite() => share(p),
                    _ => DVec3::ZERO,
                })
            }
            Layer::Steps => {
                let steps = frame.steps();
                let most = percentile_99(&steps);
                Box::new(move |i| heat((f64::from(steps[i]) / most).min(1.0)))
            }
            Layer::State => Box::new(|i| match State::from_code(frame.state[i].into()) {
                Some(State::Sky) => SKY,
                Some(State::Hit) => HIT,
                _ => UNCONVERGED,
            }),
            Layer::Samples => {
                let all = f64::from(plan.samples);
                // Without a list, every pixel has all.
                let count = |i: usize| frame.samples.get(i).map(|n| f64::from(*n));
                Box::new(move |i| DVec3::splat(count(i).map_or(1.0, |n| n / all)))
            }
            Layer::Variance => {
                // Without a list, there was one sample.
                let variance = |i: usize| frame.variance.get(i).map_or(0.0, |v| f64::from(*v));
                Box::new(move |i| DVec3::splat(variance(i).sqrt() / MOST_ERROR))
            }
            Layer::Error => Box::new(|_| UNCONVERGED),
        };
        Self {
            layer,
            size: frame.size,
            origin: frame.origin,
            ppi: plan.ppi,
            alpha: match layer {
                Layer::Color => &frame.alpha,
                _ => &[],
            },
            shade,
        }
    }

    /// Pixels per inch, if the plan says how many.
    pub fn ppi(&self) -> Option<u32> {
        self.ppi
    }

    /// The same with the errors that [`Layer::Error`] shows: of each pixel, in footprints.
    pub fn with_errors(mut self, errors: Vec<f64>) -> Self {
        if self.layer == Layer::Error {
            self.shade = Box::new(move |i| apart(errors[i]));
        }
        self
    }

    /// The display value of a pixel, counted row by row.
    pub fn at(&self, i: usize) -> DVec3 {
        (self.shade)(i)
    }

    /// Pixels along each axis.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Whether one number per pixel is enough.
    pub fn is_grey(&self) -> bool {
        self.layer.facts().channels == 1
    }

    /// Whether alpha follows the numbers of the layer.
    pub fn has_alpha(&self) -> bool {
        !self.alpha.is_empty()
    }

    /// The layer.
    pub fn layer(&self) -> Layer {
        self.layer
    }

    /// Whether the picture shows colours, and not data.
    pub fn is_color(&self) -> bool {
        self.layer == Layer::Color
    }

    /// All pixels in 8 bits: red, green, blue and perhaps alpha, or one number where the layer is
    /// grey.
    pub fn bytes(&self) -> Vec<u8> {
        let samples = self.samples(BitDepth::Eight.most());
        samples.into_iter().map(|s| s.to_le_bytes()[0]).collect()
    }

    /// All pixels as the bytes of a PNG's rows.
    pub fn rows(&self, depth: BitDepth) -> Vec<u8> {
        png::bytes(depth, &self.samples(depth.most()))
    }

    /// All pixels as whole numbers up to `most`, rows over threads: three per pixel, four with alpha,
    /// one where the layer is grey. Colours of 8 bits are dithered.
    pub(crate) fn samples(&self, most: u16) -> Vec<u16> {
        let channels = self.layer.facts().channels + usize::from(self.has_alpha());
        let is_dithered = self.is_color() && most == BitDepth::Eight.most();
        let [width, height] = self.size.map(|n| n as usize);
        // The cast saturates, and turns NaN into black.
        let whole = |value: f64| (f64::from(most) * value.clamp(0.0, 1.0) + 0.5) as u16;
        let mut out = vec![0; width * height * channels];
        for_each_part(&mut out, (width * channels).max(1), |y, row| {
            for (x, pixel) in row.chunks_mut(channels).enumerate() {
                let shade = self.at(y * width + x).to_array();
                for (to, value) in pixel.iter_mut().zip(shade) {
                    *to = match is_dithered {
                        true => {
                            let pixel = in_image(self.origin, [x as u32, y as u32]);
                            byte(level(value), pixel).into()
                        }
                        false => whole(value),
                    };
                }
                if let (Some(to), Some(share)) = (pixel.get_mut(3), self.alpha.get(y * width + x)) {
                    *to = whole(f64::from(*share));
                }
            }
        });
        out
    }
}

/// The place of a value between the least and the greatest finite one, 0..1 along each axis.
fn shares(values: &mut dyn Iterator<Item = DVec3>) -> impl Fn(DVec3) -> DVec3 + use<> {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let finite = values.filter(|v| v.is_finite());
    let (low, high) = finite.fold(start, |(low, high), v| (low.min(v), high.max(v)));
    // Values that are all the same have no range; any shade will do.
    let range = (high - low).max(DVec3::splat(f64::MIN_POSITIVE));
    move |v| ((v - low) / range).clamp(DVec3::ZERO, DVec3::ONE)
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// The colour of a signed error in footprints. The root makes small errors visible.
fn apart(e: f64) -> DVec3 {
    if e.is_nan() {
        return UNCONVERGED;
    }
    let x = (e.abs() / MOST_APART).min(1.0).sqrt();
    let stops = if e > 0.0 { TOO_DEEP } else { TOO_NEAR };
    match x {
        x if x < 0.5 => HIT.lerp(stops[0], 2.0 * x),
        x => stops[0].lerp(stops[1], 2.0 * x - 1.0),
    }
}

/// The colour of a share of 0..=1 in a heat map.
pub fn heat(x: f64) -> DVec3 {
    let at = x * (HEAT.len() - 1) as f64;
    let i = (at as usize).min(HEAT.len() - 2);
    HEAT[i].lerp(HEAT[i + 1], at - i as f64)
}

/// The value that 99 of 100 do not exceed; at least 1.
fn percentile_99(values: &[f32]) -> f64 {
    if values.is_empty() {
        return 1.0;
    }
    let mut sorted = values.to_vec();
    let at = (sorted.len() - 1) * 99 / 100;
    let (_, value, _) = sorted.select_nth_unstable_by(at, f32::total_cmp);
    f64::from(*value).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::Formula;

    fn plan() -> Plan {
        Plan::new(Formula::all().remove(0))
    }

    #[test]
    fn depth_tells_near_far_and_sky_apart() {
        let frame = Frame {
            size: [3, 1],
            depth: vec![2.0, 6.0, f32::INFINITY],
            state: vec![1, 1, 0],
            ..Frame::default()
        };
        let samples = Shades::new(Layer::Depth, &frame, &plan()).samples(255);
        assert_eq!(samples, [0, 242, 255]);
    }

    #[test]
    fn state_has_three_colours_and_steps_end_at_the_percentile() {
        let mut frame = Frame {
            size: [3, 1],
            state: vec![0, 1, 2],
            ..Frame::default()
        };
        let samples = Shades::new(Layer::State, &frame, &plan()).samples(255);
        assert_eq!(samples[6..], [255, 0, 255]);
        assert!(samples[0] < samples[3] && samples[3] == samples[4]);
        frame.work = vec![crate::base::outcome::Counts::default(); 3];
        frame.work[2].evaluations = 50;
        let shades = Shades::new(Layer::Steps, &frame, &plan());
        assert_eq!(shades.at(0), HEAT[0]);
        assert_eq!(shades.at(2), HEAT[5]);
    }

    #[test]
    fn all_sky_and_broken_numbers_do_no_harm() {
        let frame = Frame {
            size: [1, 1],
            radiance: vec![[f32::NAN, -1.0, f32::INFINITY]],
            depth: vec![f32::INFINITY],
            state: vec![0],
            ..Frame::default()
        };
        for layer in [Layer::Color, Layer::Depth, Layer::Position] {
            Shades::new(layer, &frame, &plan()).samples(65535);
        }
    }
}
