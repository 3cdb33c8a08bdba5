//! What the window can show of a frame: its picture, its layers, and how cones came to it.

use glam::DVec3;

use crate::picture::frame::{Frame, LevelLayer};
use crate::picture::{Layer, Shades, heat};
use crate::plan::{Extras, Plan};

/// What the window shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShownView {
    /// A layer of the picture.
    Layer(Layer),
    /// For each pixel the pass that ended its way: a cone level that found nothing but sky, or the
    /// ray.
    Ends,
    /// The fronts after so many cone levels: what is proven empty, as distance.
    Fronts(usize),
}

impl ShownView {
    /// What a render must keep for it.
    pub fn extras(self) -> Extras {
        match self {
            Self::Layer(layer) => layer.facts().extras,
            Self::Ends | Self::Fronts(_) => Extras {
                levels: true,
                depth_only: true,
                ..Extras::default()
            },
        }
    }

    /// A word for it.
    pub fn name(self) -> String {
        match self {
            Self::Layer(layer) => layer.name().into(),
            Self::Ends => "the pass that ended each way".into(),
            Self::Fronts(n) => format!("fronts after {} of the cone passes", n + 1),
        }
    }

    /// The bytes of the picture, four to a pixel, row by row.
    pub fn bytes(self, frame: &Frame, plan: &Plan) -> Vec<u8> {
        match self {
            Self::Layer(Layer::Color) => {
                let shades = Shades::new(Layer::Color, frame, plan);
                let bytes = shades.bytes();
                let channels = bytes.len() / frame.radiance.len().max(1);
                let opaque = |p: &[u8]| [p[0], p[1], p[2], *p.get(3).unwrap_or(&255)];
                bytes.chunks(channels.max(1)).flat_map(opaque).collect()
            }
            Self::Layer(layer) => {
                let shades = Shades::new(layer, frame, plan);
                bytes(frame, |i| shades.at(i))
            }
            Self::Ends => bytes(frame, |i| end(frame, i)),
            Self::Fronts(n) => {
                let Some(level) = frame.levels.get(n) else {
                    return bytes(frame, |_| SKY);
                };
                let known = frame.depth.iter().filter(|t| t.is_finite());
                let far = known.fold(f32::MIN_POSITIVE, |far, t| far.max(*t));
                bytes(frame, |i| match cell(frame, level, i) {
                    None | Some((_, 0)) => SKY,
                    Some((front, _)) => {
                        let share = f64::from((front / far).clamp(0.0, 1.0));
                        DVec3::splat(0.1 + 0.85 * share)
                    }
                })
            }
        }
    }
}

const SKY: DVec3 = DVec3::new(0.09, 0.15, 0.30);

fn bytes(frame: &Frame, shade: impl Fn(usize) -> DVec3) -> Vec<u8> {
    let all = (0..frame.state.len()).flat_map(|i| {
        let [r, g, b] = shade(i).to_array();
        [r, g, b, 1.0].map(|x| (255.0 * x.clamp(0.0, 1.0) + 0.5) as u8)
    });
    all.collect()
}

/// Front and state of the cell above a pixel.
fn cell(frame: &Frame, level: &LevelLayer, i: usize) -> Option<(f32, u8)> {
    let width = frame.size[0] as usize;
    let d = level.divisor as usize;
    let cell = (i / width / d) * level.cells[0] as usize + i % width / d;
    Some((*level.front.get(cell)?, *level.state.get(cell)?))
}

/// Sky gets the colour of the level that found it, from violet for the coarsest to yellow for the
/// ray. A hit is grey, the lighter the less of the way was left to the ray, by powers of ten.
fn end(frame: &Frame, i: usize) -> DVec3 {
    let passes = frame.levels.len().max(1) as f64;
    let at = frame.levels.iter().map(|level| cell(frame, level, i));
    let found = at.clone().position(|cell| cell.is_some_and(|c| c.1 == 0));
    match (found, frame.depth[i]) {
        (Some(level), _) => heat(level as f64 / passes),
        (None, t) if t.is_infinite() => heat(1.0),
        (None, t) => {
            let front = at.flatten().last().map_or(0.0, |cell| cell.0);
            // What is left to the ray, from all of the way to a ten-thousandth.
            let left = f64::from(1.0 - (front / t).clamp(0.0, 1.0)).max(1e-4);
            DVec3::splat(0.95 + 0.2125 * (-4.0 - left.log10()))
        }
    }
}
