//! What cells of a render claim against where rays truly meet the surface.

use conemarch::base::outcome::State;
use conemarch::picture::frame::Frame;
use glam::DVec3;

/// The proof needs no tolerance. f32 adds some roundings of 6e-8 to distances, and to positions,
/// which are about as far from the origin as the eye.
const ROUNDING: f64 = 1e-6;
const ROUNDING_OF_EYE: f64 = 1e-7;

/// A pixel whose cell claims more than is true.
#[derive(Debug, PartialEq)]
pub struct Overclaim {
    pub divisor: u32,
    pub pixel: [usize; 2],
    pub front: f32,
    pub state: u8,
    /// Where the pixel's ray meets the surface.
    pub t: f64,
}

/// The pixels of all levels whose cell claims more than is true: a front beyond the place where
/// the pixel's ray meets the surface, or sky where it meets one. `t` is that place for each
/// pixel, infinity for none.
pub fn overclaims(frame: &Frame, eye: DVec3, t: &[f64]) -> Vec<Overclaim> {
    let of_eye = ROUNDING_OF_EYE * eye.length();
    let width = frame.size[0] as usize;
    let mut found = Vec::new();
    for level in &frame.levels {
        let d = level.divisor as usize;
        for (i, &t) in t.iter().enumerate().filter(|(_, t)| t.is_finite()) {
            let pixel = [i % width, i / width];
            let cell = (pixel[1] / d) * level.cells[0] as usize + pixel[0] / d;
            let (front, state) = (level.front[cell], level.state[cell]);
            if f64::from(front) > t * (1.0 + ROUNDING) + of_eye || state == State::Sky as u8 {
                let divisor = level.divisor;
                found.push(Overclaim {
                    divisor,
                    pixel,
                    front,
                    state,
                    t,
                });
            }
        }
    }
    found
}

/// Share of the pixels of a surface whose finest cell brings them nine tenths of the way.
pub fn brought_near(frame: &Frame, t: &[f64]) -> f64 {
    let (width, level) = (frame.size[0] as usize, frame.levels.last().unwrap());
    let hits = t.iter().enumerate().filter(|(_, t)| t.is_finite());
    let near: Vec<bool> = hits
        .map(|(i, t)| {
            let cell = (i / width / 2) * level.cells[0] as usize + (i % width) / 2;
            f64::from(level.front[cell]) > 0.9 * t
        })
        .collect();
    near.iter().filter(|n| **n).count() as f64 / near.len() as f64
}
