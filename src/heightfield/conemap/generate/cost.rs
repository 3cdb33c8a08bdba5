//! How wide a cone one higher place allows. Twin: `wgsl/heightfield/conemap/generate/cost.wgsl`.
//!
//! A cone is bounded by every place that rises above its apex: the *cost* of a place
//! falls with its distance and with its rise, and the least cost of all is the answer.
//! Costs only have to compare like ratios, so that of a cone over samples is the square
//! of its ratio, which needs no root.
//!
//! In f64 every operation here is rounded, but never against its order: a node that is
//! no farther and no lower than a place never costs more. So a search that skips nodes
//! by their cost ends with the very bits of one that skips nothing.

use crate::heightfield::conemap::WIDEST;

/// What a place costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// `d^2 / rise^2`: no sample inside a cone over a sample.
    Cone,
    /// `(d + offset) / rise`: cells keep clear of a cone over a cell (METHOD 4's walk).
    Walk {
        /// Room in texels.
        offset: f64,
    },
}

impl Cost {
    /// The cost of a place, or the least of all places under a node, from its squared
    /// distance in texels and its rise, which must be positive.
    pub fn of(self, squared: u32, rise: f64) -> f64 {
        let squared = f64::from(squared);
        match self {
            Self::Cone => squared / (rise * rise),
            Self::Walk { offset } => (squared.sqrt() + offset) / rise,
        }
    }

    /// The cost at which nothing bounds a cone.
    pub fn widest(self) -> f64 {
        match self {
            Self::Cone => WIDEST * WIDEST,
            Self::Walk { .. } => WIDEST,
        }
    }

    /// The ratio that a cost means.
    pub fn ratio(self, cost: f64) -> f64 {
        match self {
            Self::Cone => cost.sqrt().min(WIDEST),
            Self::Walk { .. } => cost.min(WIDEST),
        }
    }
}
