//! Heights on a grid, and the surface between them.
//!
//! Lengths along x and y are in texels; a texel is the distance of two samples. Heights are
//! in 0..=1 and become lengths only in a scene, by its depth. Sample (i, j) lies at
//! x = i, y = j. Each axis either ends at its last sample or wraps to its first.
//! Twin: `wgsl/heightfield/heights.wgsl`.

use glam::DVec2;
use thiserror::Error;

use crate::base::named::named_enum;
use crate::raster::open::MOST_SIDE;

/// Why numbers are not a height map.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum HeightsError {
    /// An axis has no samples, or more than a map may have.
    #[error("a height map of {0} x {1} samples: each axis has 1 to {MOST_SAMPLES}")]
    Size(u32, u32),
    /// The number of samples is not that of the size.
    #[error("{found} heights for {wanted} samples")]
    Count {
        /// Samples of the size.
        wanted: usize,
        /// Numbers given.
        found: usize,
    },
    /// A height is not a number, or outside 0..=1.
    #[error("the height at column {x}, row {y} is {height}: heights are numbers from 0 to 1")]
    Height {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// What is there.
        height: f32,
    },
}

/// Longest axis of a height map: all positions and squared distances between samples
/// are exact in f64, and positions in f32 keep a thousandth of a texel.
pub const MOST_SAMPLES: u32 = MOST_SIDE;

named_enum! {
    /// What the normals of the surface are.
    #[derive(Default)]
    pub enum Normals {
        /// Those of the patches, which change suddenly from patch to patch.
        #[default]
        Patches = "patches",
        /// Those of slopes that change steadily: see [`Heights::slope`].
        Smooth = "smooth",
    }
}

named_enum! {
    /// What lies between the samples.
    #[derive(Default)]
    pub enum Patches {
        /// The bilinear patch of four samples: cell (i, j) spans samples i..=i+1, j..=j+1.
        #[default]
        Bilinear = "bilinear",
        /// A box as high as one sample: cell (i, j) spans positions i..=i+1, j..=j+1.
        Boxes = "boxes",
    }
}

impl Patches {
    /// The surface in words.
    pub fn surface(self) -> &'static str {
        match self {
            Self::Bilinear => "bilinear patches",
            Self::Boxes => "boxes",
        }
    }
}

/// A grid of heights.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    size: [u32; 2],
    wrap: [bool; 2],
    data: Vec<f32>,
}

impl Heights {
    /// Heights row by row, each in 0..=1.
    ///
    /// # Errors
    /// Sizes outside 1..=[`MOST_SAMPLES`], another number of heights, and heights that
    /// are not numbers from 0 to 1.
    pub fn new(size: [u32; 2], wrap: [bool; 2], data: Vec<f32>) -> Result<Self, HeightsError> {
        if size.iter().any(|n| !(1..=MOST_SAMPLES).contains(n)) {
            return Err(HeightsError::Size(size[0], size[1]));
        }
        let wanted = size[0] as usize * size[1] as usize;
        if data.len() != wanted {
            let found = data.len();
            return Err(HeightsError::Count { wanted, found });
        }
        if let Some(i) = data.iter().position(|h| !(0.0..=1.0).contains(h)) {
            return Err(HeightsError::Height {
                x: (i % size[0] as usize) as u32,
                y: (i / size[0] as usize) as u32,
                height: data[i],
            });
        }
        Ok(Self { size, wrap, data })
    }

    /// Samples along each axis.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Which axes wrap.
    pub fn wrap(&self) -> [bool; 2] {
        self.wrap
    }

    /// All heights, row by row.
    pub fn data(&self) -> &[f32] {
        &self.data
    }

    /// The sample that an index names: beyond the ends the last one, or on a wrapping
    /// axis the one that comes round.
    pub fn index(&self, axis: usize, i: i64) -> u32 {
        brought_in(i, self.size[axis], self.wrap[axis])
    }

    /// The height of a sample, its indices brought into the grid by [`Self::index`].
    pub fn at(&self, x: i64, y: i64) -> f64 {
        let (x, y) = (self.index(0, x), self.index(1, y));
        f64::from(self.data[(y * self.size[0] + x) as usize])
    }

    /// The slope of a smooth surface through the samples, at a sample, in heights per texel: that
    /// between its two neighbours, or its only neighbour at an end.
    pub fn slope(&self, x: i64, y: i64) -> DVec2 {
        let span = |axis: usize, i: i64| {
            let last = i64::from(self.size[axis]) - 1;
            match self.wrap[axis] {
                true => 2.0,
                false => ((i + 1).min(last) - (i - 1).max(0)).max(1) as f64,
            }
        };
        DVec2::new(
            (self.at(x + 1, y) - self.at(x - 1, y)) / span(0, x),
            (self.at(x, y + 1) - self.at(x, y - 1)) / span(1, y),
        )
    }

    /// Cells along each axis. Between n samples that do not wrap there are n - 1
    /// bilinear patches, and one flat one where there is a single sample.
    pub fn cells(&self, patches: Patches) -> [u32; 2] {
        cells(self.size, self.wrap, patches)
    }

    /// The four corner heights of a bilinear cell: (0, 0), (1, 0), (0, 1), (1, 1). All
    /// are the same for a box.
    pub fn corners(&self, patches: Patches, x: i64, y: i64) -> [f64; 4] {
        match patches {
            Patches::Bilinear => [
                self.at(x, y),
                self.at(x + 1, y),
                self.at(x, y + 1),
                self.at(x + 1, y + 1),
            ],
            Patches::Boxes => [self.at(x, y); 4],
        }
    }

    /// The highest point of a cell, its *apex*.
    pub fn apex(&self, patches: Patches, x: i64, y: i64) -> f64 {
        let c = self.corners(patches, x, y);
        c[0].max(c[1]).max(c[2]).max(c[3])
    }

    /// The places of a grid of cones, with their heights row by row: all cells with their
    /// apexes, or all samples.
    pub fn places(&self, cells: Option<Patches>) -> ([u32; 2], Vec<f32>) {
        let heights = match cells {
            Some(patches) => self.apexes(patches),
            None => self.data.clone(),
        };
        (self.places_along(cells), heights)
    }

    /// Places along each axis: cells, or samples.
    pub fn places_along(&self, cells: Option<Patches>) -> [u32; 2] {
        cells.map_or(self.size, |patches| self.cells(patches))
    }

    /// Apexes of all cells, row by row.
    pub fn apexes(&self, patches: Patches) -> Vec<f32> {
        let cells = grid(self.cells(patches)).map(|cell| cell.map(i64::from));
        cells
            .map(|[x, y]| self.apex(patches, x, y) as f32)
            .collect()
    }

    /// The height of the surface at a position; outside the grid that of its border, or
    /// of the tile that comes round.
    pub fn height(&self, patches: Patches, p: DVec2) -> f64 {
        let cell = p.floor();
        let f = p - cell;
        bilinear(
            self.corners(patches, cell.x as i64, cell.y as i64),
            f.x,
            f.y,
        )
    }
}

/// Bilinear interpolation at (u, v) between values at (0, 0), (1, 0), (0, 1), (1, 1).
pub fn bilinear(corners: [f64; 4], u: f64, v: f64) -> f64 {
    let [a, b, c, d] = corners;
    let low = a + u * (b - a);
    let high = c + u * (d - c);
    low + v * (high - low)
}

/// The place of an index on an axis with so many places: beyond the ends the last one, or
/// where the axis wraps the one that comes round.
pub fn brought_in(i: i64, count: u32, wraps: bool) -> u32 {
    let n = i64::from(count);
    let i = if (0..n).contains(&i) {
        // Most indices, and a division takes long.
        i
    } else if wraps {
        i.rem_euclid(n)
    } else {
        i.clamp(0, n - 1)
    };
    i as u32
}

/// As [`Heights::cells`], for heights of a size and wrapping.
pub fn cells(size: [u32; 2], wrap: [bool; 2], patches: Patches) -> [u32; 2] {
    [0, 1].map(|a| {
        if patches == Patches::Boxes || wrap[a] {
            size[a]
        } else {
            (size[a] - 1).max(1)
        }
    })
}

/// Words for the axes that wrap.
pub const WRAPS: [(&str, [bool; 2]); 4] = [
    ("none", [false, false]),
    ("x", [true, false]),
    ("y", [false, true]),
    ("xy", [true, true]),
];

/// Which axes wrap as a word.
pub fn wrap_name(wrap: [bool; 2]) -> &'static str {
    WRAPS[usize::from(wrap[0]) + 2 * usize::from(wrap[1])].0
}

/// The axes that a word of [`WRAPS`] means.
pub fn wrap_named(word: &str) -> Option<[bool; 2]> {
    let found = WRAPS.into_iter().find(|(name, _)| *name == word);
    found.map(|(_, wrap)| wrap)
}

/// The places of a grid, row by row.
pub fn grid([w, h]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    (0..h).flat_map(move |y| (0..w).map(move |x| [x, y]))
}

/// One axis of a grid of places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Places on it.
    pub count: u32,
    /// Whether the last is next to the first.
    pub wrap: bool,
}

impl Axis {
    /// Steps from a place to the nearest of the places `low..=high`, which may lie beyond the
    /// grid: across the border where that is shorter. 0 if it is one of them.
    pub fn gap(self, from: u32, [low, high]: [i64; 2]) -> u32 {
        let (from, n) = (i64::from(from), i64::from(self.count));
        let to = |from: i64| (low - from).max(from - high).max(0);
        let steps = match self.wrap {
            true => to(from).min(to(from + n)).min(to(from - n)),
            false => to(from),
        };
        steps as u32
    }
}
