//! How wide a cone one higher place allows. Twin: `wgsl/heightfield/conemap/generate/cost.wgsl`.
//!
//! Every place that rises above an apex bounds its cone. The *cost* of a place grows with
//! its distance and falls with its rise above the apex; the least cost of all places gives
//! the ratio. Costs only have to be in the same order as ratios. For cones over samples the
//! cost is the square of the ratio, which needs no root.
//!
//! In f64 every operation here is rounded, but keeps the order: a node that is no farther
//! and no lower than a place never costs more. A search that skips nodes by their cost
//! therefore ends with the very bits of one that skips nothing.

use crate::base::shader::Module;
use crate::heightfield::conemap::WIDEST;
use crate::wgsl;

/// Costs that are closer than this, relative to them, may compare wrongly in f32. WGSL
/// allows 4.5 units in the last place for a root and 2.5 for a division; with one half
/// for each of the other operations two costs are apart by 2^-19 at the worst.
const MARGIN: f64 = 1.0 / 262_144.0;

/// The least rise that a device looks at: a place of the least distance that counts, a
/// thousandth of a texel, with this rise costs far more than the widest cone. Its
/// square, 2^-80, is no denormal, which devices may take for 0.
const LEAST_RISE: f64 = 1.0 / (1_u64 << 40) as f64;

/// A factor beyond 1 that outweighs the rounding of a few operations in f64.
const SURELY: f64 = 1.0 + 1e-12;

/// What a place costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// `d^2 / rise^2`: no sample inside a cone over a sample.
    Cone,
    /// `(d + offset) / rise`: cells keep clear of a cone over a cell (docs/method.md, 4).
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

    /// Whether a cost is surely no less than `best`. It takes neither the root nor the quotient,
    /// which most places of a search do not need.
    pub fn exceeds(self, squared: u32, rise: f64, best: f64) -> bool {
        let squared = f64::from(squared);
        match self {
            Self::Cone => squared >= best * (rise * rise) * SURELY,
            Self::Walk { offset } => {
                let steps = best * rise * SURELY - offset;
                steps < 0.0 || squared >= steps * steps * SURELY
            }
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

    /// The WGSL of the cost, for searches that measure distances in so many units per texel.
    pub fn module(self, units: f64) -> Module {
        let walk = matches!(self, Self::Walk { .. });
        wgsl!(
            "heightfield/conemap/generate/cost.wgsl",
            "COST_WALK" = f64::from(u8::from(walk)),
            "COST_UNITS" = units,
            "COST_WIDEST" = self.widest(),
            "COST_MARGIN" = MARGIN,
            "COST_LEAST_RISE" = LEAST_RISE,
        )
    }
}
