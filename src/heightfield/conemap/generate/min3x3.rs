//! The 3 x 3 minimum of a cone map (Bán, Valasek, Bálint, Vad: Robust Cone Step Mapping,
//! EGSR 2024), on the CPU and on a device with the same result.
//! Twin: `wgsl/heightfield/conemap/generate/min3x3.wgsl`.

use crate::base::parallel::collect;
use crate::base::shader::Program;
use crate::heightfield::{ConeMap, heights::brought_in};
use crate::wgsl;

/// The index of a place along an axis: beyond the ends the last place, or where the axis
/// wraps the one that comes round.
pub(crate) fn beside(map: &ConeMap, axis: usize, i: i64) -> usize {
    brought_in(i, map.size[axis], map.wrap[axis]) as usize
}

/// A map whose cones are as narrow as the narrowest among each place and its eight
/// neighbours, channel by channel.
pub fn min3x3(map: &ConeMap) -> ConeMap {
    let [width, height] = map.size.map(|n| n as usize);
    let channels = map.ratios.len() / (width * height);
    let least = |i: usize| {
        let (place, channel) = (i / channels, i % channels);
        let (x, y) = ((place % width) as i64, (place / width) as i64);
        let nine = (0..9).map(|k| {
            let (x, y) = (beside(map, 0, x + k % 3 - 1), beside(map, 1, y + k / 3 - 1));
            map.ratios[(y * width + x) * channels + channel]
        });
        nine.fold(f64::INFINITY, f64::min)
    };
    ConeMap {
        ratios: collect(0..map.ratios.len(), 1, least),
        ..*map
    }
}

/// The program that makes a band of the 3 x 3 minimum.
pub fn program() -> Program {
    Program::new(
        "min3x3",
        vec![wgsl!("heightfield/conemap/generate/min3x3.wgsl")],
    )
}
