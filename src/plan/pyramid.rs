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

/// The cone levels of a picture, from the coarsest to 1/2; none in modes without cones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pyramid {
    /// Levels, coarsest first.
    pub levels: Vec<Level>,
}

impl Pyramid {
    /// Levels from `coarsest`, a power of two, down to 2; none for 1. `fudge` goes from coarse
    /// to fine and its last value repeats. `steps` is the step limit of a cell.
    pub fn new(coarsest: u32, fudge: &[f64], steps: u32) -> Self {
        let count = coarsest.max(1).ilog2();
        let last = fudge.last().copied().unwrap_or(1.0);
        let levels = (0..count).map(|i| Level {
            divisor: coarsest >> i,
            fudge: fudge.get(i as usize).copied().unwrap_or(last),
            steps,
        });
        Self {
            levels: levels.collect(),
        }
    }

    /// Divisor of the first level; 1 without levels.
    pub fn coarsest(&self) -> u32 {
        self.levels.first().map_or(1, |l| l.divisor)
    }
}

/// A rectangle of pixels of the full image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// First pixel.
    pub origin: [u32; 2],
    /// Pixels along each axis.
    pub size: [u32; 2],
}

impl Block {
    /// Cuts an image into blocks, row by row. Their edge is the largest multiple of `coarsest`
    /// that is at most `edge`, but at least `coarsest`.
    pub fn cut(size: [u32; 2], edge: u32, coarsest: u32) -> Vec<Block> {
        let edge = (edge / coarsest).max(1) * coarsest;
        let mut blocks = Vec::new();
        for y in (0..size[1]).step_by(edge as usize) {
            for x in (0..size[0]).step_by(edge as usize) {
                blocks.push(Block {
                    origin: [x, y],
                    size: [edge.min(size[0] - x), edge.min(size[1] - y)],
                });
            }
        }
        blocks
    }

    /// Pixels in the block.
    pub fn area(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_lie_inside_their_parents_and_cover_the_image() {
        for size in [[1, 1], [33, 17], [1366, 768], [1, 400], [1600, 1050]] {
            let pyramid = Pyramid::new(32, &[1.0], 1);
            assert_eq!(pyramid.levels.len(), 5);
            for pair in pyramid.levels.windows(2) {
                assert_eq!(pair[0].divisor, 2 * pair[1].divisor);
                let (parent, child) = (pair[0].cells(size), pair[1].cells(size));
                for axis in 0..2 {
                    assert!((child[axis] - 1) / 2 < parent[axis]);
                    assert!(child[axis] * pair[1].divisor >= size[axis]);
                }
            }
        }
    }

    #[test]
    fn blocks_cover_every_pixel_once() {
        let size = [100, 70];
        let blocks = Block::cut(size, 40, 16);
        let area: usize = blocks.iter().map(Block::area).sum();
        assert_eq!(area, 7000);
        for b in &blocks {
            assert!(b.origin.iter().all(|o| o % 16 == 0));
        }
        // A block is never thinner than one cell of the coarsest level.
        assert_eq!(Block::cut([20, 20], 3, 16).len(), 4);
    }
}
