//! Where the levels of a pyramid of maxima lie in one buffer, and the program that fills it.
//! Twin: `wgsl/heightfield/conemap/generate/pyramid.wgsl`.

use crate::base::shader::Program;
use crate::heightfield::conemap::generate::uniform::PyramidUniform;
use crate::heightfield::{MaxMip, heights::grid, max_mip::MipLevel};
use crate::wgsl;

/// The tiles of a pyramid of maxima: level n holds, for each of its nodes, the maxima of
/// the four children on level n - 1. A grid of a single place has one tile, too.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tiles {
    /// Values along each axis of the grid.
    pub size: [u32; 2],
    /// Nodes along each axis, by level; of level 0 the grid's own.
    pub levels: Vec<[u32; 2]>,
    /// Where each level's tiles begin; level 0 has none.
    pub at: Vec<u32>,
    /// Tiles altogether.
    pub count: u32,
}

impl Tiles {
    /// The layout over a grid.
    pub fn new(size: [u32; 2]) -> Self {
        let mut tiles = Self {
            size,
            levels: vec![size],
            at: vec![0],
            count: 0,
        };
        let mut below = size;
        loop {
            below = below.map(|n| n.div_ceil(2));
            tiles.levels.push(below);
            tiles.at.push(tiles.count);
            tiles.count += below[0] * below[1];
            if below == [1, 1] {
                return tiles;
            }
        }
    }

    /// The parameters for making a level.
    pub fn uniform(&self, level: usize) -> PyramidUniform {
        PyramidUniform {
            below: self.levels[level - 1],
            size: self.levels[level],
            below_at: self.at[level - 1],
            at: self.at[level],
            first: u32::from(level == 1),
            pad: 0,
        }
    }

    /// The pyramid that tiles hold.
    pub fn unpack(&self, tiles: &[[f32; 4]]) -> MaxMip {
        let level = |n: usize| {
            let size = self.levels[n];
            let value = |[x, y]: [u32; 2]| {
                if n + 1 < self.levels.len() {
                    let row = self.levels[n + 1][0];
                    let tile = self.at[n + 1] + (y / 2) * row + x / 2;
                    tiles[tile as usize][(2 * (y % 2) + x % 2) as usize]
                } else {
                    // The single node on top has no tile to lie in.
                    let all = tiles[self.at[n] as usize];
                    all.into_iter().fold(f32::NEG_INFINITY, f32::max)
                }
            };
            let max = grid(size).map(value).collect();
            MipLevel { size, max }
        };
        // Over a single place there is a tile, but no level above it.
        let count = if self.size == [1, 1] {
            1
        } else {
            self.levels.len()
        };
        MaxMip {
            levels: (0..count).map(level).collect(),
        }
    }
}

/// The program that makes one level of tiles.
pub fn program() -> Program {
    Program::new(
        "pyramid",
        vec![wgsl!("heightfield/conemap/generate/pyramid.wgsl")],
    )
}
