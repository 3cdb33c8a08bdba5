//! Pyramids of maxima over a grid (Tevs, Ihrke, Seidel: Maximum Mipmaps, I3D 2008), of
//! any size: each level halves the one below rounding up, so that no row or column is
//! lost. Twin: `wgsl/heightfield/max_mip.wgsl`.

use crate::heightfield::heights::grid;

/// A rectangle of places: the lowest and the highest along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Places {
    /// Lowest.
    pub low: [u32; 2],
    /// Highest.
    pub high: [u32; 2],
}

/// Values of one level, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct MipLevel {
    /// Nodes along each axis.
    pub size: [u32; 2],
    /// The largest value under each node.
    pub max: Vec<f32>,
}

impl MipLevel {
    /// The value of a node.
    pub fn at(&self, x: u32, y: u32) -> f32 {
        self.max[(y * self.size[0] + x) as usize]
    }
}

/// Maxima from the grid itself (level 0) to one single node.
#[derive(Clone, Debug, PartialEq)]
pub struct MaxMip {
    /// Fine to coarse. A node (x, y) of level n covers the places `x * 2^n` up to
    /// `(x + 1) * 2^n - 1` of the grid, as far as there are any.
    pub levels: Vec<MipLevel>,
}

impl MaxMip {
    /// The pyramid over a grid of at least one value.
    pub fn new(size: [u32; 2], values: Vec<f32>) -> Self {
        debug_assert_eq!(values.len(), size[0] as usize * size[1] as usize);
        let mut levels = vec![MipLevel { size, max: values }];
        while let Some(below) = levels.last()
            && below.size != [1, 1]
        {
            let above = Self::halved(below);
            levels.push(above);
        }
        Self { levels }
    }

    fn halved(below: &MipLevel) -> MipLevel {
        let size = below.size.map(|n| n.div_ceil(2));
        let last = below.size.map(|n| n - 1);
        let over = |[x, y]: [u32; 2]| {
            let (right, down) = ((2 * x + 1).min(last[0]), (2 * y + 1).min(last[1]));
            let top = below.at(2 * x, 2 * y).max(below.at(right, 2 * y));
            top.max(below.at(2 * x, down)).max(below.at(right, down))
        };
        let max = grid(size).map(over).collect();
        MipLevel { size, max }
    }

    /// The places `low..=high` of the grid under a node.
    pub fn places(&self, level: usize, node: [u32; 2]) -> Places {
        let grid = self.levels[0].size;
        let low = [node[0] << level, node[1] << level];
        let end = |a: usize| (low[a] + (1 << level) - 1).min(grid[a] - 1);
        let high = [end(0), end(1)];
        Places { low, high }
    }

    /// The windows of every level. A window is two by two neighbouring nodes: window (x, y) is of
    /// the nodes x - 1 and x, and y - 1 and y. Along an axis that goes `round`, the last node is
    /// beside the first, at the outer sides of the block too. Elsewhere there is nothing beside them.
    /// Levels below `finest` are empty.
    pub fn windows(&self, round: [bool; 2], finest: u32) -> Vec<MipLevel> {
        let of = |level: &MipLevel| {
            // The nodes before and after the place of a window.
            let pair = |axis: usize, i: u32| {
                let last = level.size[axis] - 1;
                let ends = if round[axis] { [last, 0] } else { [0, last] };
                let before = if i == 0 { ends[0] } else { i - 1 };
                [before, if i > last { ends[1] } else { i }]
            };
            let size = level.size.map(|n| n + 1);
            let over = |[x, y]: [u32; 2]| {
                let ([x0, x1], [y0, y1]) = (pair(0, x), pair(1, y));
                let row = |y| level.at(x0, y).max(level.at(x1, y));
                row(y0).max(row(y1))
            };
            MipLevel {
                size,
                max: grid(size).map(over).collect(),
            }
        };
        let none = MipLevel {
            size: [0; 2],
            max: Vec::new(),
        };
        let levels = (0..).zip(&self.levels);
        let all = levels.map(|(n, level)| if n < finest { none.clone() } else { of(level) });
        all.collect()
    }

    /// The level of the single node.
    pub fn coarsest(&self) -> u32 {
        self.levels.len() as u32 - 1
    }

    /// The largest value of all.
    pub fn top(&self) -> f32 {
        self.levels[self.levels.len() - 1].max[0]
    }
}
