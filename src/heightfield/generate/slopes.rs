//! Slopes and normals at the samples.
//!
//! Cone maps of old carry the slopes of the surface in two more channels, of eight bits
//! each. As published they are half of what their reader takes them for, are one half
//! too small again at borders, and make flat ground tilt, since 127 is not the middle of
//! 0..=255. They are here to write files that such readers know; everything else takes
//! slopes from the heights.

use glam::DVec3;
use rayon::prelude::*;

use crate::heightfield::heights::Heights;

/// Rise per texel along both axes at each sample, by central differences; at a border
/// that does not wrap by the difference to the one neighbour that there is.
pub fn slopes(heights: &Heights) -> Vec<[f64; 2]> {
    over(heights, |x, y| {
        [0, 1].map(|axis| {
            let [low, high, steps] = beside(heights, axis, x, y, f64::from);
            if steps > 0.0 {
                (high - low) / steps
            } else {
                0.0
            }
        })
    })
}

/// Unit normals at the samples, of a relief as deep as so many texels.
pub fn normals(heights: &Heights, depth: f64) -> Vec<DVec3> {
    let slopes = slopes(heights).into_par_iter();
    let normal = |[x, y]: [f64; 2]| DVec3::new(-depth * x, -depth * y, 1.0).normalize();
    slopes.map(normal).collect()
}

/// The two slope channels as Dummer's preprocessor writes them (Cone Step Mapping, 2006,
/// appendix B): heights of eight bits, the difference of the two neighbours halved, and
/// halved again about 127, down for y; each division of whole numbers drops the rest.
/// Axes that wrap use the neighbour that comes round, which his program does not.
pub fn dummer_slopes(heights: &Heights) -> Vec<[u8; 2]> {
    let byte = |z: f32| f64::from((z * 255.0).round());
    over(heights, |x, y| {
        [0, 1].map(|axis| {
            let [low, high, _] = beside(heights, axis, x, y, byte);
            let der = (high - low) as i32 / 2;
            let stored = if axis == 0 {
                127 + der / 2
            } else {
                127 - der / 2
            };
            // 64 to 190: the difference of two bytes, quartered, about 127.
            stored as u8
        })
    })
}

/// The heights of the two neighbours along an axis, and the steps between them.
fn beside(heights: &Heights, axis: usize, x: i64, y: i64, of: impl Fn(f32) -> f64) -> [f64; 3] {
    let last = i64::from(heights.size()[axis]) - 1;
    let here = [x, y][axis];
    let (down, up) = if heights.wrap()[axis] {
        (1, 1)
    } else {
        (here.min(1), (last - here).min(1))
    };
    let at = |step: i64| {
        let at = if axis == 0 {
            [x + step, y]
        } else {
            [x, y + step]
        };
        // Heights are f32 to begin with.
        of(heights.at(at[0], at[1]) as f32)
    };
    [at(-down), at(up), (down + up) as f64]
}

fn over<T: Send>(heights: &Heights, one: impl Fn(i64, i64) -> T + Sync) -> Vec<T> {
    let [w, h] = heights.size().map(i64::from);
    let all = (0..w * h).into_par_iter();
    all.map(|i| one(i % w, i / w)).collect()
}
