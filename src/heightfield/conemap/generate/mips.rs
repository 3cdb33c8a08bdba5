//! Pyramids of cone maps for coarse look-ups: each node holds the highest apex and the
//! narrowest cone under it.
//!
//! If the apex of a cone is raised and its ratio lowered, the new cone lies within the old
//! one. So a node's cone, put over any of its places, is inside the cone of that place.
//! Averages, which graphics hardware makes by default, promise nothing. Sizes
//! halve rounding up, so that no row or column is lost.

use crate::base::parallel::collect;
use crate::heightfield::ConeMap;
use crate::heightfield::conemap::file::share_down;

/// One level.
#[derive(Clone, Debug, PartialEq)]
pub struct ConeLevel {
    /// Nodes along each axis.
    pub size: [u32; 2],
    /// The highest apex under each node, row by row.
    pub heights: Vec<f32>,
    /// The least ratio under each node; of a quad map four after one another.
    pub ratios: Vec<f64>,
}

/// All levels over a map of apexes, one height to each place, from the map itself to a
/// single node; `None` if there are not as many heights as places.
pub fn mips(heights: &[f32], map: &ConeMap) -> Option<Vec<ConeLevel>> {
    let places = map.size[0] as usize * map.size[1] as usize;
    if places == 0 || heights.len() != places || !map.ratios.len().is_multiple_of(places) {
        return None;
    }
    let mut levels = vec![ConeLevel {
        size: map.size,
        heights: heights.to_vec(),
        ratios: map.ratios.clone(),
    }];
    while let Some(below) = levels.last()
        && below.size != [1, 1]
    {
        let above = halved(below);
        levels.push(above);
    }
    Some(levels)
}

fn halved(below: &ConeLevel) -> ConeLevel {
    let size = below.size.map(|n| n.div_ceil(2));
    let channels = below.ratios.len() / below.heights.len();
    let under = |node: usize| {
        let (x, y) = (node as u32 % size[0], node as u32 / size[0]);
        [0, 1, 2, 3].map(|i| {
            let x = (2 * x + i % 2).min(below.size[0] - 1);
            let y = (2 * y + i / 2).min(below.size[1] - 1);
            (y * below.size[0] + x) as usize
        })
    };
    let nodes = size[0] as usize * size[1] as usize;
    let highest = |node: usize| {
        let all = under(node).map(|i| below.heights[i]);
        all.into_iter().fold(f32::NEG_INFINITY, f32::max)
    };
    let least = |i: usize| {
        let (node, channel) = (i / channels, i % channels);
        let all = under(node).map(|i| below.ratios[i * channels + channel]);
        all.into_iter().fold(f64::INFINITY, f64::min)
    };
    ConeLevel {
        size,
        heights: collect(0..nodes, 1, highest),
        ratios: collect(0..nodes * channels, 1, least),
    }
}

/// Ratios as bytes to bind, each rounded down.
pub fn stored<'a>(ratios: impl IntoIterator<Item = &'a f64>) -> Vec<u8> {
    let stored = ratios.into_iter().map(|r| share_down(*r, 1.0));
    stored.flat_map(f32::to_ne_bytes).collect()
}
