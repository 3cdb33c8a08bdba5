//! What cells of a render claim against where rays truly meet the surface.

use conemarch::base::outcome::State;
use conemarch::picture::frame::Frame;

/// The proof needs no tolerance; f32 adds some roundings of 6e-8 to positions and
/// distances.
const ROUNDING: f64 = 1e-6;

/// Pixels, over all levels, whose cell claims more than is true: a front beyond the
/// place where the pixel's ray meets the surface, or sky where it meets one. `t` is that
/// place for each pixel, infinity for none.
pub fn overclaims(frame: &Frame, t: &[f64]) -> usize {
    let width = frame.size[0] as usize;
    let mut count = 0;
    for level in &frame.levels {
        let d = level.divisor as usize;
        for (i, &t) in t.iter().enumerate().filter(|(_, t)| t.is_finite()) {
            let cell = (i / width / d) * level.cells[0] as usize + (i % width) / d;
            let beyond = f64::from(level.front[cell]) > t * (1.0 + ROUNDING);
            count += usize::from(beyond || level.state[cell] == State::Sky as u8);
        }
    }
    count
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
