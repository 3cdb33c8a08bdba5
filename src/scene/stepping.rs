//! How a scene takes its steps: what a mode decides (docs/method.md, 2).

use crate::base::cone::ConeRule;

/// How rays stretch their steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Relaxation {
    /// Steps are the radius of the empty ball.
    Off,
    /// Steps follow the measured slope of the radius.
    #[default]
    Auto,
    /// Steps are this many radii, 1 to 2.
    Factor(f64),
}

impl Relaxation {
    /// The number in the WGSL struct.
    pub fn code(self) -> f64 {
        match self {
            Self::Off => 1.0,
            Self::Auto => 0.0,
            Self::Factor(f) => f,
        }
    }
}

/// How a scene takes its steps. A ray's *hit threshold* at a distance is `detail` footprints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// A ray hits where the estimate is at most so many footprints.
    pub detail: f64,
    /// Share of the hit threshold that steps keep clear of, from 0 to less than 1.
    pub shell: f64,
    /// How rays stretch their steps.
    pub relaxation: Relaxation,
    /// Factor on ray steps; less than 1 for the truth.
    pub stride: f64,
    /// The rule of the cones.
    pub rule: ConeRule,
    /// Whether rays start where they enter the bounds.
    pub clip: bool,
    /// Whether rays go by proven balls, as cones do.
    pub proven: bool,
}
