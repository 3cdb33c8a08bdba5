//! Cone maps: for every place of a grid, how wide a cone that opens upward from it stays empty.
//!
//! A *place* is a sample of the height map, or a cell between samples. The *apex* of its cone
//! is at the sample's height, or at the highest point of the cell. The *ratio* of a cone is
//! its radius, in texels, at one whole height above the apex.
//!
//! - [`mod@file`]: cone maps in files
//! - [`generate`]: the generators

use crate::base::named::named_enum;
use crate::heightfield::conemap::{file::Layout, generate::Generator};
use crate::heightfield::heights::{Patches, cells};

pub mod file;
pub mod generate;

/// What all maps of a kind have in common.
#[derive(Clone, Copy, Debug)]
pub struct KindFacts {
    /// Whether places are cells instead of samples.
    pub over_cells: bool,
    /// Cones per place.
    pub channels: usize,
    /// What the cones promise, in words.
    pub promise: &'static str,
    /// What makes such maps by default.
    pub generator: Generator,
    /// The PNG layout that such maps have by default.
    pub layout: Layout,
}

named_enum! {
    /// What the cones of a map promise, which decides which tracers may use them.
    pub enum MapKind: KindFacts {
        /// Apex on a sample; no other sample lies inside (Dummer 2006). The surface between
        /// the samples may.
        Samples = "samples" => KindFacts {
            over_cells: false,
            channels: 1,
            promise: "apex on a sample, no other sample inside",
            generator: Generator::Exact,
            layout: Layout::Dummer,
        },
        /// As `Samples`, with one cone per side: +x, -x, +y, -y.
        Quad = "quad" => KindFacts {
            over_cells: false,
            channels: 4,
            promise: "apex on a sample, one cone for each of four sides",
            generator: Generator::Quad,
            layout: Layout::Quad,
        },
        /// Apex on a sample; a ray from above through the cone should meet the surface at
        /// most once (Policarpo and Oliveira 2007).
        Relaxed = "relaxed" => KindFacts {
            over_cells: false,
            channels: 1,
            promise: "apex on a sample, a ray inside should cross the surface once",
            generator: Generator::RelaxedExact,
            layout: Layout::Relief,
        },
        /// Apex over a cell; the cells that rise above it keep clear by an offset (the cone
        /// walk). Proven for the surface between the samples.
        Walk = "walk" => KindFacts {
            over_cells: true,
            channels: 1,
            promise: "apex over a cell, proven for the surface between the samples",
            generator: Generator::Walk,
            layout: Layout::Pair,
        },
        /// As `Walk`, for rays that go down: only the cells from which a ray can come out on
        /// the far side limit the cone.
        WalkRelaxed = "walk-relaxed" => KindFacts {
            over_cells: true,
            channels: 1,
            promise: "apex over a cell, proven for rays that go down",
            generator: Generator::WalkRelaxed,
            layout: Layout::Pair,
        },
    }
}

impl MapKind {
    /// Whether places are cells instead of samples.
    pub fn over_cells(self) -> bool {
        self.facts().over_cells
    }

    /// Places along each axis of a map of heights.
    pub fn places(self, samples: [u32; 2], wrap: [bool; 2], patches: Patches) -> [u32; 2] {
        match self.over_cells() {
            true => cells(samples, wrap, patches),
            false => samples,
        }
    }

    /// Cones per place.
    pub fn channels(self) -> usize {
        self.facts().channels
    }
}

/// The ratio of a cone that nothing limits, in texels per whole height. It is finite so that
/// no arithmetic on it makes an infinity.
pub const WIDEST: f64 = 65_536.0;

/// The ratios of the cones over a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct ConeMap {
    /// What the cones promise.
    pub kind: MapKind,
    /// Places along each axis.
    pub size: [u32; 2],
    /// Which axes wrap.
    pub wrap: [bool; 2],
    /// Room that the cones of a walk leave, in texels; 0 for the other kinds.
    pub offset: f64,
    /// Horizontal distance in texels over difference in height, where 0 to 1 is the whole
    /// height: 0 to [`WIDEST`], row by row, all cones of a place together.
    pub ratios: Vec<f64>,
}

impl ConeMap {
    /// A map of one cone of no width, for programs that read no cones.
    pub fn none() -> Self {
        Self {
            kind: MapKind::Samples,
            size: [1, 1],
            wrap: [false; 2],
            offset: 0.0,
            ratios: vec![0.0],
        }
    }

    /// Mean ratio.
    pub fn mean(&self) -> f64 {
        self.ratios.iter().sum::<f64>() / self.ratios.len() as f64
    }
}
