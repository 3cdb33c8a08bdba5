//! The pyramid of cone levels (docs/method.md, 1).
//!
//! A level with divisor D has `ceil(W/D) x ceil(H/D)` cells. Cell (i, j) covers the D x D
//! pixels from (iD, jD), as far as the image goes. Each divisor is half the one before, so
//! a cell's four children cover the same pixels, at every image size.

/// One level, with cells of `divisor` x `divisor` pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Pixels per cell along each axis; a power of two.
    pub divisor: u32,
    /// Factor on the chord of the level's cones, in (0, 1].
    pub fudge: f64,
    /// The step limit of a cell.
    pub steps: u32,
}

impl Level {
    /// Cells along each axis over so many pixels.
    pub fn cells(&self, size: [u32; 2]) -> [u32; 2] {
        size.map(|n| n.div_ceil(self.divisor))
    }
}

/// The levels from `coarsest`, a power of two, down to 2; none for 1. `fudge` goes from coarse to
/// fine and its last value repeats. `steps` is the step limit of a cell.
pub fn levels(coarsest: u32, fudge: &[f64], steps: u32) -> Vec<Level> {
    let last = fudge.last().copied().unwrap_or(1.0);
    let level = |i: u32| Level {
        divisor: coarsest >> i,
        fudge: fudge.get(i as usize).copied().unwrap_or(last),
        steps,
    };
    (0..coarsest.ilog2()).map(level).collect()
}

/// The longest edge of a block in pixels. Two places fit into one word of 32 bits.
pub const MOST_EDGE: u32 = 65_535;

/// A rectangle of pixels of the full image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// First pixel.
    pub origin: [u32; 2],
    /// Pixels along each axis.
    pub size: [u32; 2],
}

impl Block {
    /// Cuts a rectangle of pixels into blocks, row by row. Their edge is the largest multiple of `coarsest`
    /// that is at most `edge`, but at least `coarsest`. One with no more pixels than such a
    /// block is one block, if no edge exceeds [`MOST_EDGE`].
    pub fn cut(self, edge: u32, coarsest: u32) -> Vec<Block> {
        let size = self.size;
        let edge = (edge / coarsest).max(1) * coarsest;
        let [area, most] = [size, [edge; 2]].map(|s| u64::from(s[0]) * u64::from(s[1]));
        let longest = size[0].max(size[1]);
        let edge = match area <= most && longest <= MOST_EDGE {
            true => longest,
            false => edge,
        };
        let starts = |axis: usize| (0..size[axis]).step_by(edge as usize);
        let blocks = starts(1).flat_map(|y| starts(0).map(move |x| [x, y]));
        let block = |start: [u32; 2]| Block {
            origin: [0, 1].map(|axis| self.origin[axis] + start[axis]),
            size: [0, 1].map(|axis| edge.min(size[axis] - start[axis])),
        };
        blocks.map(block).collect()
    }

    /// Pixels in the block.
    pub fn area(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }
}
