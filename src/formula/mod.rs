//! Formulas: shapes given by an estimate of the distance to them.
//!
//! - [`mandelbox`]: the Mandelbox, and its Julia sets; `folds`: one iteration; `orbit`, `julia`
//!   and `scalar`: its estimates; `folds_lanes` and `orbit_lanes`: several orbits side by side;
//!   `traps`: how near orbits come to shapes
//! - [`balls`]: balls, boxes and a rod, for tests
//! - [`rotation`]: a rotation between folds
//! - `contract`: [`DistanceEstimate`], what a scene asks a formula
//!
//! A new formula is a file here, a twin in `wgsl/formula/` and a word in the list
//! `formulas!` below. The documentation and the tests follow that list.

pub mod balls;
mod contract;
mod folds;
mod folds_lanes;
mod julia;
pub mod mandelbox;
mod orbit;
mod orbit_lanes;
pub mod rotation;
mod scalar;
mod traps;

pub use contract::{Bounds, DistanceEstimate, Evaluate, Evaluator, Reading};
pub use traps::Traps;

/// Makes the enum of all formulas from one list: module and type of each.
macro_rules! formulas {
    ($($module:ident :: $type:ident),* $(,)?) => {
        /// One of the built-in formulas with its parameters.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Formula {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $type($module::$type)),*
        }

        impl Formula {
            /// Every formula with its default parameters.
            pub fn all() -> Vec<Formula> {
                vec![$(Formula::$type($module::$type::default())),*]
            }
        }

        impl std::ops::Deref for Formula {
            type Target = dyn DistanceEstimate + Send + Sync;
            fn deref(&self) -> &Self::Target {
                match self { $(Formula::$type(f) => f),* }
            }
        }

        impl std::ops::DerefMut for Formula {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self { $(Formula::$type(f) => f),* }
            }
        }
    };
}

formulas![mandelbox::Mandelbox, balls::Balls];
